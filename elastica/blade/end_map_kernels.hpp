// A curve and its Jacobi fields by Taylor pieces. Only the sources that are compiled once per instruction set
// include it: what it takes in must bring no function of its own.
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "elastica/blade/end_map_lanes.hpp"
#include "elastica/curve/taylor.hpp"

namespace hotblade::elastica {
namespace {

// Lane 0 carries the curve's own rate theta', lanes 1 to 3 the fields d theta/d(kappa, lambda1, lambda2): all
// four need the same two products, with cos(theta) and with sin(theta).
using Lanes = double __attribute__((vector_size(4 * sizeof(double))));

#define HOTBLADE_INLINE static inline __attribute__((always_inline))

// a b + c in all lanes, rounded once where the instruction set has that.
HOTBLADE_INLINE Lanes fused(Lanes a, double b, Lanes c) {
#if defined(__AVX2__) && defined(__FMA__)
  return (Lanes)_mm256_fmadd_pd((__m256d)a, _mm256_set1_pd(b), (__m256d)c);
#else
  return a * b + c;
#endif
}

// Of the series: at the pieces' length this leaves (0.6/2.8)^13 = 2e-9 of what taylor.hpp tells.
constexpr int kSearchOrder = 12;

// 1 / k, so that no term divides.
struct Inverse {
  double of[kTaylorOrder + 3] = {};
  constexpr Inverse() {
    for (int k = 1; k < kTaylorOrder + 3; ++k) of[k] = 1.0 / k;
  }
};
constexpr Inverse kInverse;

template <int kOrder>
struct Series {
  Lanes w[kOrder + 2];   // (theta', fields)
  Lanes wc[kOrder + 1];  // w cos(theta)
  Lanes ws[kOrder + 1];  // w sin(theta)
  double c[kOrder + 1], s[kOrder + 1];
};

// State at a piece's end: the point and tangent, fields (d theta) in lanes 1 to 3, their rates, and d x, d y.
struct State {
  double x, y, theta, kappa, c, s;
  Lanes u{}, du{}, dx{}, dy{};
};

template <int kOrder>
HOTBLADE_INLINE void expand(Series<kOrder>& p, const State& a, double l1, double l2) {
  p.c[0] = a.c;
  p.s[0] = a.s;
  p.w[0] = a.u;
  p.w[0][0] = a.kappa;
  p.w[1] = a.du;
  p.w[1][0] = l2 * p.c[0] - l1 * p.s[0];
#pragma GCC unroll 32
  for (int k = 0; k <= kOrder; ++k) {
    // Three sums of each product side by side: one alone would wait for itself. The newest term, which the
    // next order waits for, is added last.
    Lanes wc[3] = {}, ws[3] = {};
#pragma GCC unroll 32
    for (int j = k; j >= 1; --j) {
      wc[j % 3] = fused(p.w[j], p.c[k - j], wc[j % 3]);
      ws[j % 3] = fused(p.w[j], p.s[k - j], ws[j % 3]);
    }
    p.wc[k] = fused(p.w[0], p.c[k], wc[0] + wc[1] + wc[2]);
    p.ws[k] = fused(p.w[0], p.s[k], ws[0] + ws[1] + ws[2]);
    if (k == kOrder) break;
    const double next = kInverse.of[k + 1], after = kInverse.of[k + 2];
    p.c[k + 1] = -p.ws[k][0] * next;
    p.s[k + 1] = p.wc[k][0] * next;
    // u'' = -(lambda1 cos + lambda2 sin) u - dlambda1 sin + dlambda2 cos; theta'' itself for lane 0.
    const Lanes second = Lanes{0, 0, -p.s[k], p.c[k]} - (l1 * p.wc[k] + l2 * p.ws[k]);
    p.w[k + 2] = second * (next * after);
    p.w[k + 2][0] = (l2 * p.c[k + 1] - l1 * p.s[k + 1]) * after;
  }
}

template <int kOrder>
HOTBLADE_INLINE State advance(const Series<kOrder>& p, const State& a, double h) {
  Lanes w{}, dw{}, ic{}, is{}, base{}, tangent{};
#pragma GCC unroll 32
  for (int k = kOrder; k >= 0; --k) {
    const double inverse = kInverse.of[k + 1];
    dw = fused(dw, h, p.w[k + 1] * double(k + 1));
    w = fused(w, h, p.w[k]);
    ic = fused(ic, h, p.wc[k] * inverse);
    is = fused(is, h, p.ws[k] * inverse);
    base = fused(base, h, Lanes{p.c[k], p.s[k], p.w[k][0], 0} * inverse);
    if constexpr (kOrder < kTaylorOrder) tangent = fused(tangent, h, Lanes{p.c[k], p.s[k], 0, 0});
  }
  base *= h;
  State b;
  b.x = a.x + base[0];
  b.y = a.y + base[1];
  b.theta = a.theta + base[2];
  b.kappa = w[0];
  // The series of theta has one order more: in a search that does not count.
  b.c = kOrder < kTaylorOrder ? tangent[0] : __builtin_cos(b.theta);
  b.s = kOrder < kTaylorOrder ? tangent[1] : __builtin_sin(b.theta);
  b.u = w;
  b.du = dw;
  b.dx = a.dx - is * h;
  b.dy = a.dy + ic * h;
  return b;
}

HOTBLADE_INLINE void put(const State& a, int zeros, double largest_turn, FieldState& out) {
  out.x = a.x;
  out.y = a.y;
  out.theta = a.theta;
  out.kappa = a.kappa;
  for (int i = 0; i < 3; ++i) {
    out.dx[i] = a.dx[i + 1];
    out.dy[i] = a.dy[i + 1];
    out.dtheta[i] = a.u[i + 1];
    out.rates[i] = a.du[i + 1];
  }
  out.zeros = zeros;
  out.largest_turn = largest_turn;
}

template <int kOrder>
void run_fields(const FieldRun& run, FieldState* out, int count) {
  State a{run.x, run.y, run.theta, run.kappa, __builtin_cos(run.theta), __builtin_sin(run.theta)};
  a.du[1] = 1;
  Series<kOrder> series;
  int zeros = 0;
  double largest_turn = 0;
  const int first = run.pieces - count;
  for (int i = 0; i < run.pieces; ++i) {
    expand(series, a, run.lambda1, run.lambda2);
    const State b = advance(series, a, run.piece);
    if (i > 0 && (a.u[1] < 0) != (b.u[1] < 0)) ++zeros;
    const double turn = b.theta < run.theta ? run.theta - b.theta : b.theta - run.theta;
    if (turn > largest_turn) largest_turn = turn;
    if (i >= first) put(b, zeros, largest_turn, out[i - first]);
    a = b;
  }
}

[[maybe_unused]] constexpr EndMapKernels kKernels = {run_fields<kTaylorOrder>, run_fields<kSearchOrder>};

}  // namespace
}  // namespace hotblade::elastica
