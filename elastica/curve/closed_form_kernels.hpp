// The batch loops of the closed form over SIMD lanes. Only the sources that are compiled once per
// instruction set include it (elastica/kernels/simd_lanes.h).
#pragma once

#include "elastica/kernels/simd_lanes.h"
// The lanes come first: what follows is written in them.
#include "elastica/curve/closed_form_lanes.hpp"

namespace hotblade::elastica {
namespace {

void store_some(double* to, size_t i, hb_lanes v, size_t count) {
  if (to) hb_store(to + i, v, count);
}

// Vectors side by side on the ladder.
constexpr int kAbreast = 4;

template <int Vectors>
__attribute__((always_inline)) inline void jacobi_block(const hb_ladder& ladder, double modulus,
                                                        const JacobiLanes& b, size_t i, size_t count) {
  const hb_lanes scale = HB_BROADCAST(modulus > 1 ? modulus : 1.0);
  hb_jacobi j[Vectors];
  for (int v = 0; v < Vectors; ++v) {
    j[v] = hb_jacobi_bottom(&ladder, scale * hb_load(b.u + i + static_cast<size_t>(v) * HB_LANES, count));
  }
  hb_jacobi_climb(&ladder, j, Vectors);
  for (int v = 0; v < Vectors; ++v) {
    const size_t at = i + static_cast<size_t>(v) * HB_LANES;
    const hb_jacobi r = hb_jacobi_of_modulus(&ladder, modulus, j + v);
    store_some(b.sn, at, r.sn, count);
    store_some(b.cn, at, r.cn, count);
    store_some(b.dn, at, r.dn, count);
    store_some(b.e, at, r.wave, count);
  }
}

void jacobi_samples(const hb_ladder& ladder, double modulus, const JacobiLanes& b, size_t n) {
  size_t i = 0;
  for (; i + kAbreast * HB_LANES <= n; i += kAbreast * HB_LANES) {
    jacobi_block<kAbreast>(ladder, modulus, b, i, HB_LANES);
  }
  for (; i < n; i += HB_LANES) jacobi_block<1>(ladder, modulus, b, i, n - i < HB_LANES ? n - i : HB_LANES);
}

template <int Vectors>
__attribute__((always_inline)) inline void curve_block(const hb_ladder& ladder, const hb_closed_form& form,
                                                       const CurveLanes& b, size_t i, size_t count) {
  hb_lanes argument[Vectors];
  hb_jacobi j[Vectors];
  for (int v = 0; v < Vectors; ++v) {
    argument[v] = hb_closed_form_argument(&form, hb_load(b.s + i + static_cast<size_t>(v) * HB_LANES, count));
    j[v] = hb_jacobi_bottom(&ladder, argument[v]);
  }
  hb_jacobi_climb(&ladder, j, Vectors);
  for (int v = 0; v < Vectors; ++v) {
    const size_t at = i + static_cast<size_t>(v) * HB_LANES;
    const hb_curve_point p = hb_closed_form_point(&form, argument[v], j + v);
    store_some(b.x, at, p.x, count);
    store_some(b.y, at, p.y, count);
    store_some(b.tangent_x, at, p.tangent_x, count);
    store_some(b.tangent_y, at, p.tangent_y, count);
    store_some(b.kappa, at, p.kappa, count);
  }
}

void curve_samples(const hb_ladder& ladder, const hb_closed_form& form, const CurveLanes& b, size_t n) {
  size_t i = 0;
  for (; i + kAbreast * HB_LANES <= n; i += kAbreast * HB_LANES)
    curve_block<kAbreast>(ladder, form, b, i, HB_LANES);
  for (; i < n; i += HB_LANES) curve_block<1>(ladder, form, b, i, n - i < HB_LANES ? n - i : HB_LANES);
}

constexpr ClosedFormKernels kClosedFormKernels = {jacobi_samples, curve_samples};

}  // namespace
}  // namespace hotblade::elastica
