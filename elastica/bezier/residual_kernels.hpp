// The batch loops of the lambda-residual over SIMD lanes. Only the sources that are compiled once per
// instruction set include it (elastica/kernels/simd_lanes.h).
#pragma once

#include "elastica/kernels/graded_lanes.h"
// The lanes come first: what follows is written in them.
#include "elastica/bezier/residual_lanes.hpp"
#include "elastica/kernels/edge_residual.h"
#include "elastica/kernels/sincos.h"

namespace hotblade::elastica {
namespace {

// Where the numbers of some curves stand: side by side, or anywhere.
struct InARow {
  size_t first, count;
  __attribute__((always_inline)) hb_lanes load(const double* from) const {
    return hb_load(from + first, count);
  }
  __attribute__((always_inline)) void store(double* to, hb_lanes v) const { hb_store(to + first, v, count); }
  [[nodiscard]] size_t at(size_t i) const { return first + i; }
};

struct Scattered {
  const size_t* index;
  size_t count;
  __attribute__((always_inline)) hb_lanes load(const double* from) const {
    double v[HB_LANES];
    for (size_t i = 0; i < HB_LANES; ++i) v[i] = from[index[i]];
    return hb_load(v, HB_LANES);
  }
  __attribute__((always_inline)) void store(double* to, hb_lanes v) const {
    for (size_t i = 0; i < count; ++i) to[index[i]] = v[i];
  }
  [[nodiscard]] size_t at(size_t i) const { return index[i]; }
};

// Runs both formulas over all curves of a batch; `load` gives a curve in lanes.
template <typename Load, typename Plain, typename Graded, typename Store>
inline __attribute__((always_inline)) void each_curve(const ResidualLanes& b, size_t n, const Load& load,
                                                      const Plain& plain, const Graded& graded,
                                                      const Store& store) {
  const auto put = [&](const auto& r, const auto& where) __attribute__((always_inline)) {
    where.store(b.e, r.e);
    if (b.bound) where.store(b.bound, r.bound);
    for (size_t i = 0; i < where.count; ++i) b.status[where.at(i)] = static_cast<uint8_t>(r.status[i]);
    store(r, where);
    return hb_wants_panels(r.bound, r.status);
  };
  hb_each_curve(
      n,
      [&](size_t first, size_t count) __attribute__((always_inline)) {
        const InARow where{first, count};
        return put(plain(load(where)), where);
      },
      [&](const size_t* index, size_t count) {
        const Scattered where{index, count};
        put(graded(load(where)), where);
      });
}

// A curve in its unit frame.
struct Framed {
  hb_legs legs;
  hb_lanes status;
};

constexpr auto kNothingMore = [](const auto&, const auto&) {};

void residuals_of_curves(const ResidualLanes& b, size_t n) {
  each_curve(
      b, n,
      [&](const auto& where) __attribute__((always_inline)) {
        const auto leg = [&](int k) __attribute__((always_inline)) {
          return where.load(b.in[k]) - where.load(b.in[k % 2]);
        };
        Framed f{{leg(2), leg(3), leg(4), leg(5), leg(6), leg(7)}, {}};
        f.status = hb_unit_frame(&f.legs);
        return f;
      },
      [](const Framed& f) __attribute__((always_inline)) { return hb_plain_residual(&f.legs, f.status); },
      [](const Framed& f) __attribute__((always_inline)) { return hb_graded_residual(&f.legs, f.status); },
      kNothingMore);
}

template <typename Where>
inline __attribute__((always_inline)) hb_edges load_edges(const ResidualLanes& b, const Where& where) {
  const hb_sincos first = hb_sincos_of(where.load(b.in[0])), second = hb_sincos_of(where.load(b.in[1]));
  return {first.cos, first.sin, second.cos, second.sin, where.load(b.in[2]), where.load(b.in[3])};
}

void residuals_of_edges(const ResidualLanes& b, size_t n) {
  each_curve(
      b, n, [&](const auto& where) __attribute__((always_inline)) { return load_edges(b, where); },
      [](const hb_edges& a) __attribute__((always_inline)) { return hb_edge_residual_of(&a); },
      [](const hb_edges& a) __attribute__((always_inline)) { return hb_graded_edge_residual_of(&a); },
      kNothingMore);
}

void gradients_of_edges(const ResidualLanes& b, size_t n) {
  each_curve(
      b, n, [&](const auto& where) __attribute__((always_inline)) { return load_edges(b, where); },
      [](const hb_edges& a) __attribute__((always_inline)) { return hb_edge_residual_gradient(&a); },
      [](const hb_edges& a) __attribute__((always_inline)) { return hb_graded_edge_gradient(&a); },
      [&](const hb_edge_residual& r, const auto& where) __attribute__((always_inline)) {
        where.store(b.by_l1, r.by_l1);
        where.store(b.by_l2, r.by_l2);
      });
}

constexpr ResidualKernels kResidualKernels = {residuals_of_curves, residuals_of_edges, gradients_of_edges};

}  // namespace
}  // namespace hotblade::elastica
