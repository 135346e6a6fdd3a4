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

// A square of lanes, rows made columns: each step exchanges, between rows that are kApart from each other,
// the squares of that size off the diagonal.
template <size_t... kLane>
struct Order {};
#if HB_LANES == 8
using EveryLane = Order<0, 1, 2, 3, 4, 5, 6, 7>;
#elif HB_LANES == 4
using EveryLane = Order<0, 1, 2, 3>;
#else
using EveryLane = Order<0, 1>;
#endif

template <size_t kApart, size_t... kLane>
inline __attribute__((always_inline)) void transpose(hb_lanes (&square)[HB_LANES], Order<kLane...> order) {
  for (size_t i = 0; i < HB_LANES; ++i) {
    if (i & kApart) continue;
    const hb_lanes a = square[i], b = square[i + kApart];
    square[i] = __builtin_shuffle(
        a, b, hb_lanes_mask{static_cast<long long>(kLane & kApart ? kLane - kApart + HB_LANES : kLane)...});
    square[i + kApart] = __builtin_shuffle(
        a, b, hb_lanes_mask{static_cast<long long>(kLane & kApart ? kLane + HB_LANES : kLane + kApart)...});
  }
  if constexpr (kApart > 1) transpose<kApart / 2>(square, order);
}

// Curves as rows of kNumbers, x0 y0 .. x3 y3: some of them as a number a vector of lanes.
constexpr size_t kNumbers = 8;
struct Rows {
  hb_lanes number[kNumbers];

  __attribute__((always_inline)) Rows(const double* from, const InARow& where) {
    if (where.count == HB_LANES) {
      for (size_t part = 0; part < kNumbers; part += HB_LANES) {
        hb_lanes square[HB_LANES];
        for (size_t i = 0; i < HB_LANES; ++i)
          square[i] = hb_load(from + (where.first + i) * kNumbers + part, HB_LANES);
        transpose<HB_LANES / 2>(square, EveryLane());
        for (size_t i = 0; i < HB_LANES; ++i) number[part + i] = square[i];
      }
    } else {
      for (size_t i = 0; i < HB_LANES; ++i)
        for (size_t k = 0; k < kNumbers; ++k)
          number[k][i] = from[(where.first + (i < where.count ? i : where.count - 1)) * kNumbers + k];
    }
  }
  Rows(const double* from, const Scattered& where) {
    for (size_t i = 0; i < HB_LANES; ++i)
      for (size_t k = 0; k < kNumbers; ++k) number[k][i] = from[where.index[i] * kNumbers + k];
  }
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

// `numbers` gives a function from k to the lanes of a curve's k-th number.
template <typename Numbers>
inline __attribute__((always_inline)) void residuals_of(const ResidualLanes& b, size_t n,
                                                        const Numbers& numbers) {
  each_curve(
      b, n,
      [&](const auto& where) __attribute__((always_inline)) {
        const auto number = numbers(where);
        const auto leg = [&](int k) __attribute__((always_inline)) {
          return number(k) - number(k % 2);
        };
        Framed f{{leg(2), leg(3), leg(4), leg(5), leg(6), leg(7)}, {}};
        f.status = hb_unit_frame(&f.legs);
        return f;
      },
      [](const Framed& f) __attribute__((always_inline)) { return hb_plain_residual(&f.legs, f.status); },
      [](const Framed& f) __attribute__((always_inline)) { return hb_graded_residual(&f.legs, f.status); },
      kNothingMore);
}

void residuals_of_curves(const ResidualLanes& b, size_t n) {
  residuals_of(
      b, n, [&](const auto& where) __attribute__((always_inline)) {
        return [&](int k) __attribute__((always_inline)) {
          return where.load(b.in[k]);
        };
      });
}

void residuals_of_rows(const ResidualLanes& b, size_t n) {
  residuals_of(
      b, n, [&](const auto& where) __attribute__((always_inline)) {
        return [rows = Rows(b.in[0], where)](int k) __attribute__((always_inline)) {
          return rows.number[k];
        };
      });
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

constexpr ResidualKernels kResidualKernels = {residuals_of_curves, residuals_of_rows, residuals_of_edges,
                                              gradients_of_edges};

}  // namespace
}  // namespace hotblade::elastica
