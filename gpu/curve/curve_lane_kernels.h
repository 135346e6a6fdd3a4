// The lanes of curve_nearest.h over many points and of graded_residual.h over many curves, compiled once for
// each instruction set; see elastica/kernels/simd_lanes.h for what the including file may use.
#pragma once

#include "elastica/kernels/graded_lanes.h"
// Lanes first.
#include "gpu/curve/curve_lanes.hpp"
#include "gpu/kernels/curve_nearest.h"

namespace hotblade::gpu {
namespace {

template <typename Nearest>
inline __attribute__((always_inline)) std::size_t each_point(const CurveQueries& q, const Nearest& nearest) {
  const HB_REAL scale = HB_BROADCAST(q.scale), back = HB_BROADCAST(1 / q.scale);
  std::size_t count = 0;
  for (std::size_t first = 0; first < q.n; first += HB_LANES) {
    const std::size_t lanes = q.n - first < HB_LANES ? q.n - first : HB_LANES;
    const hb_curve_foot foot = nearest((hb_load(q.x + first, lanes) - HB_BROADCAST(q.ox)) * scale,
                                       (hb_load(q.y + first, lanes) - HB_BROADCAST(q.oy)) * scale);
    hb_store(q.distance + first, foot.distance * back, lanes);
    hb_store(q.t + first, foot.t, lanes);
    const HB_MASK unsure = HB_NOT(foot.settled);
    if (!HB_ANY(unsure)) continue;
    for (std::size_t i = 0; i < lanes; ++i) {
      q.unsure[count] = static_cast<unsigned>(first + i);
      count += unsure[i] != 0;
    }
  }
  return count;
}

std::size_t on_whole(const hb_curve_whole& curve, const CurveQueries& queries) {
  return each_point(
      queries, [&](HB_REAL x, HB_REAL y)
                   __attribute__((always_inline)) { return hb_curve_foot_on_whole(&curve, x, y); });
}

std::size_t on_pieces(const hb_curve_piece* pieces, int count, double sag, const CurveQueries& queries) {
  return each_point(
      queries, [&](HB_REAL x, HB_REAL y) __attribute__((always_inline)) {
        return hb_curve_foot_on_pieces(pieces, count, sag, x, y);
      });
}

// `at(i)` is the number of the curve in lane i.
template <typename At>
inline __attribute__((always_inline)) hb_legs legs_of(const double* curves, const At& at) {
  double numbers[8][HB_LANES];
  for (std::size_t i = 0; i < HB_LANES; ++i) {
    for (std::size_t k = 0; k < 8; ++k) numbers[k][i] = curves[8 * at(i) + k];
  }
  HB_REAL c[8];
  for (int k = 0; k < 8; ++k) c[k] = hb_load(numbers[k], HB_LANES);
  return {c[2] - c[0], c[3] - c[1], c[4] - c[0], c[5] - c[1], c[6] - c[0], c[7] - c[1]};
}

template <typename At>
inline __attribute__((always_inline)) void store_residuals(const CurveResiduals& out, const hb_residual& r,
                                                           const At& at, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    out.e[at(i)] = r.e[i];
    out.status[at(i)] = static_cast<std::uint8_t>(r.status[i]);
    if (out.bound) out.bound[at(i)] = r.bound[i];
  }
}

// Missing lanes repeat the last curve.
void residuals_of_curves(const double* curves, std::size_t n, const CurveResiduals& out) {
  hb_each_curve(
      n,
      [&](std::size_t first, std::size_t count) __attribute__((always_inline)) {
        const auto at = [&](std::size_t i) { return first + (i < count ? i : count - 1); };
        hb_legs p = legs_of(curves, at);
        const HB_REAL frame_status = hb_unit_frame(&p);
        const hb_residual r = hb_plain_residual(&p, frame_status);
        store_residuals(out, r, at, count);
        return hb_wants_panels(r.bound, r.status);
      },
      [&](const std::size_t* index, std::size_t count) {
        const auto at = [&](std::size_t i) { return index[i]; };
        hb_legs p = legs_of(curves, at);
        const HB_REAL frame_status = hb_unit_frame(&p);
        store_residuals(out, hb_graded_residual(&p, frame_status), at, count);
      });
}

}  // namespace
}  // namespace hotblade::gpu
