#include "elastica/blade/end_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>

namespace hotblade::elastica {

namespace {

// Lane 0 carries the curve's own rate theta', lanes 1 to 3 the fields d theta/d(kappa, lambda1, lambda2): all
// four need the same two products, with cos(theta) and with sin(theta).
using Lanes = double __attribute__((vector_size(4 * sizeof(double))));

// Everything down to run_body() is inlined into one copy for each instruction set.
#define HOTBLADE_INLINE [[gnu::always_inline]] inline

// Of the series: at the pieces' length this leaves (0.6/2.8)^13 = 2e-9 of what taylor.hpp tells.
constexpr int kSearchOrder = 12;

// 1 / k, so that no term divides.
constexpr auto kInverse = [] {
  std::array<double, kTaylorOrder + 3> inverse{};
  for (std::size_t k = 1; k < inverse.size(); ++k) inverse[k] = 1.0 / static_cast<double>(k);
  return inverse;
}();

template <int kOrder>
struct Series {
  Lanes w[kOrder + 2];   // (theta', fields)
  Lanes wc[kOrder + 1];  // w cos(theta)
  Lanes ws[kOrder + 1];  // w sin(theta)
  double c[kOrder + 1], s[kOrder + 1];
};

// State at a piece's end: the point, fields (d theta) in lanes 1 to 3, their rates, and d x, d y.
struct State {
  CurvePoint point;
  Lanes u{}, du{}, dx{}, dy{};
};

template <int kOrder>
HOTBLADE_INLINE void expand(Series<kOrder>& p, const State& a, double l1, double l2) {
  p.c[0] = std::cos(a.point.theta);
  p.s[0] = std::sin(a.point.theta);
  p.w[0] = a.u;
  p.w[0][0] = a.point.kappa;
  p.w[1] = a.du;
  p.w[1][0] = l2 * p.c[0] - l1 * p.s[0];
#pragma GCC unroll 32
  for (int k = 0; k <= kOrder; ++k) {
    // Two sums of each product side by side, the newest terms last: one alone would wait for itself.
    Lanes wc[2] = {p.w[0] * p.c[k], {}}, ws[2] = {p.w[0] * p.s[k], {}};
#pragma GCC unroll 32
    for (int j = k; j >= 1; --j) {
      wc[j % 2] += p.w[j] * p.c[k - j];
      ws[j % 2] += p.w[j] * p.s[k - j];
    }
    p.wc[k] = wc[0] + wc[1];
    p.ws[k] = ws[0] + ws[1];
    if (k == kOrder) break;
    const auto next = static_cast<std::size_t>(k + 1);
    p.c[k + 1] = -p.ws[k][0] * kInverse[next];
    p.s[k + 1] = p.wc[k][0] * kInverse[next];
    // u'' = -(lambda1 cos + lambda2 sin) u - dlambda1 sin + dlambda2 cos; theta'' itself for lane 0.
    const Lanes second = Lanes{0, 0, -p.s[k], p.c[k]} - (l1 * p.wc[k] + l2 * p.ws[k]);
    p.w[k + 2] = second * (kInverse[next] * kInverse[next + 1]);
    p.w[k + 2][0] = (l2 * p.c[k + 1] - l1 * p.s[k + 1]) * kInverse[next + 1];
  }
}

template <int kOrder>
HOTBLADE_INLINE State advance(const Series<kOrder>& p, const State& a, double h) {
  Lanes w{}, dw{}, ic{}, is{}, base{};
#pragma GCC unroll 32
  for (int k = kOrder; k >= 0; --k) {
    const double inverse = kInverse[static_cast<std::size_t>(k + 1)];
    dw = dw * h + p.w[k + 1] * double(k + 1);
    w = w * h + p.w[k];
    ic = ic * h + p.wc[k] * inverse;
    is = is * h + p.ws[k] * inverse;
    base = base * h + Lanes{p.c[k], p.s[k], p.w[k][0], 0} * inverse;
  }
  base *= h;
  State b;
  b.point = {a.point.x + base[0], a.point.y + base[1], a.point.theta + base[2], w[0]};
  b.u = w;
  b.du = dw;
  b.dx = a.dx - is * h;
  b.dy = a.dy + ic * h;
  return b;
}

// Negative eigenvalues with the end point held: those with the end free along the force, counted by Sturm's
// oscillation theorem (zeros of d theta/d kappa inside), plus those of the Schur complement of the end-point
// constraints, minus the constraints (Haynsworth's additivity).
int index_of(const Eigen::Matrix3d& f, int zeros, bool straight) {
  // At a zero itself the complement is unbounded; a value of rounding's size keeps its sign.
  const double head = f(2, 0) != 0 ? f(2, 0) : std::numeric_limits<double>::min();
  const Eigen::Matrix2d schur = f.block<2, 2>(0, 1) - f.block<2, 1>(0, 0) * f.block<1, 2>(2, 1) / head;
  if (straight) return zeros + (schur.trace() < 0 ? 1 : 0) - 1;
  const double det = f.determinant() / head;
  return zeros + (det < 0 ? 1 : schur.trace() < 0 ? 2 : 0) - 2;
}

JacobiFields fields_of(const State& a, double s, int zeros, bool straight) {
  JacobiFields f;
  f.s = s;
  f.point = a.point;
  f.fields << a.dx[1], a.dx[2], a.dx[3], a.dy[1], a.dy[2], a.dy[3], a.u[1], a.u[2], a.u[3];
  f.rates << a.du[1], a.du[2], a.du[3];
  f.index = index_of(f.fields, zeros, straight);
  return f;
}

// Pieces for a curve, at least so many.
int pieces_of(const Elastica& e, int at_least) {
  for (const double v : {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length}) {
    if (!std::isfinite(v)) throw std::logic_error("elastica parameters must be finite");
  }
  const double wanted =
      std::ceil(e.length * taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2) / kStepOmega);
  if (!(e.length > 0) || !(wanted <= ElasticaCurve::kMaxPieces)) {
    throw std::logic_error("elastica has no length, or winds too tightly for it to be evaluated");
  }
  return std::max(at_least, static_cast<int>(wanted));
}

// Runs over n pieces and puts the fields at the ends of the last ones into `out`, as many as it holds.
template <int kOrder>
HOTBLADE_INLINE void run_body(const Elastica& e, int n, std::span<JacobiFields> out) {
  const double h = e.length / n;
  State a;
  a.point = {e.x, e.y, e.theta, e.kappa};
  a.du[1] = 1;
  Series<kOrder> series;
  int zeros = 0;
  // Turning below which the blade is a line to rounding: the end point cannot move along it to first order.
  constexpr double kStraight = 1e-6;
  double largest_turn = 0;
  const int first = n - static_cast<int>(out.size());
  for (int i = 0; i < n; ++i) {
    expand(series, a, e.lambda1, e.lambda2);
    const State b = advance(series, a, h);
    if (i > 0 && (a.u[1] < 0) != (b.u[1] < 0)) ++zeros;
    largest_turn = std::max(largest_turn, std::abs(b.point.theta - e.theta));
    if (i >= first) {
      out[static_cast<std::size_t>(i - first)] = fields_of(b, h * (i + 1), zeros, largest_turn < kStraight);
    }
    a = b;
  }
}

HOTBLADE_INLINE void run_to(Exactness exactness, const Elastica& e, int n, std::span<JacobiFields> out) {
  if (exactness == Exactness::kSearch) return run_body<kSearchOrder>(e, n, out);
  run_body<kTaylorOrder>(e, n, out);
}

#if defined(__x86_64__)
// Four lanes fill these registers: wider ones have nothing to add.
[[gnu::target("avx2,fma")]] void run_256(Exactness exactness, const Elastica& e, int n,
                                         std::span<JacobiFields> out) {
  run_to(exactness, e, n, out);
}
#endif

void run(Exactness exactness, const Elastica& e, int n, std::span<JacobiFields> out, Simd simd) {
#if defined(__x86_64__)
  if (simd != Simd::kBaseline) return run_256(exactness, e, n, out);
#endif
  static_cast<void>(simd);
  run_to(exactness, e, n, out);
}

}  // namespace

JacobiFields end_map(const Elastica& elastica, Exactness exactness, Simd simd) {
  JacobiFields last;
  run(exactness, elastica, pieces_of(elastica, 1), {&last, 1}, simd);
  return last;
}

std::vector<JacobiFields> jacobi_fields(const Elastica& elastica, int at_least, Simd simd) {
  const int n = pieces_of(elastica, std::max(1, at_least));
  std::vector<JacobiFields> all(static_cast<std::size_t>(n));
  run(Exactness::kRounding, elastica, n, all, simd);
  return all;
}

}  // namespace hotblade::elastica
