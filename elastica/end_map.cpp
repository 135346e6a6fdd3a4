#include "elastica/end_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hotblade::elastica {

namespace {

// Lane 0 carries the curve's own rate theta', lanes 1 to 3 the fields d theta/d(kappa, lambda1, lambda2): all
// four need the same two products, with cos(theta) and with sin(theta).
using Lanes = Eigen::Array4d;

constexpr int kOrder = kTaylorOrder;

struct Series {
  Lanes w[kOrder + 2];   // (theta', fields)
  Lanes wc[kOrder + 1];  // w cos(theta)
  Lanes ws[kOrder + 1];  // w sin(theta)
  double c[kOrder + 1], s[kOrder + 1];
};

// State at a piece's end: the point, fields (d theta) in lanes 1 to 3, their rates, and d x, d y.
struct State {
  CurvePoint point;
  Lanes u = Lanes::Zero(), du = Lanes::Zero(), dx = Lanes::Zero(), dy = Lanes::Zero();
};

void expand(Series& p, const State& a, double lambda1, double lambda2) {
  const double l1 = lambda1, l2 = lambda2;
  p.c[0] = std::cos(a.point.theta);
  p.s[0] = std::sin(a.point.theta);
  p.w[0] = a.u;
  p.w[0][0] = a.point.kappa;
  p.w[1] = a.du;
  p.w[1][0] = l2 * p.c[0] - l1 * p.s[0];
  for (int k = 0; k <= kOrder; ++k) {
    Lanes wc = Lanes::Zero(), ws = Lanes::Zero();
    for (int j = 0; j <= k; ++j) {
      wc += p.w[j] * p.c[k - j];
      ws += p.w[j] * p.s[k - j];
    }
    p.wc[k] = wc;
    p.ws[k] = ws;
    if (k == kOrder) break;
    p.c[k + 1] = -ws[0] / (k + 1);
    p.s[k + 1] = wc[0] / (k + 1);
    // u'' = -(lambda1 cos + lambda2 sin) u - dlambda1 sin + dlambda2 cos; theta'' itself for lane 0.
    Lanes second = -(l1 * wc + l2 * ws);
    second[2] -= p.s[k];
    second[3] += p.c[k];
    p.w[k + 2] = second / ((k + 1) * (k + 2));
    p.w[k + 2][0] = (l2 * p.c[k + 1] - l1 * p.s[k + 1]) / (k + 2);
  }
}

State advance(const Series& p, const State& a, double h) {
  Lanes w = Lanes::Zero(), dw = Lanes::Zero(), ic = Lanes::Zero(), is = Lanes::Zero(), base = Lanes::Zero();
  for (int k = kOrder; k >= 0; --k) {
    const double inverse = 1.0 / (k + 1);
    dw = dw * h + p.w[k + 1] * double(k + 1);
    w = w * h + p.w[k];
    ic = ic * h + p.wc[k] * inverse;
    is = is * h + p.ws[k] * inverse;
    base = base * h + Lanes(p.c[k], p.s[k], p.w[k][0], 0) * inverse;
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

JacobiFields fields_of(const State& a, double s) {
  JacobiFields f;
  f.s = s;
  f.point = a.point;
  f.fields << a.dx[1], a.dx[2], a.dx[3], a.dy[1], a.dy[2], a.dy[3], a.u[1], a.u[2], a.u[3];
  f.rates << a.du[1], a.du[2], a.du[3];
  return f;
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

// Runs over the pieces and hands the fields at every piece's end to `visit`.
template <typename Visit>
void run(const Elastica& e, int at_least, Visit visit) {
  for (const double v : {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length}) {
    if (!std::isfinite(v)) throw std::logic_error("elastica parameters must be finite");
  }
  const double wanted =
      std::ceil(e.length * taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2) / kStepOmega);
  if (!(e.length > 0) || !(wanted <= ElasticaCurve::kMaxPieces)) {
    throw std::logic_error("elastica has no length, or winds too tightly for it to be evaluated");
  }
  const int n = std::max(at_least, static_cast<int>(wanted));
  const double h = e.length / n;
  State a;
  a.point = {e.x, e.y, e.theta, e.kappa};
  a.du[1] = 1;
  Series series;
  int zeros = 0;
  // Turning below which the blade is a line to rounding: the end point cannot move along it to first order.
  constexpr double kStraight = 1e-6;
  double largest_turn = 0;
  for (int i = 0; i < n; ++i) {
    expand(series, a, e.lambda1, e.lambda2);
    const State b = advance(series, a, h);
    if (i > 0 && (a.u[1] < 0) != (b.u[1] < 0)) ++zeros;
    largest_turn = std::max(largest_turn, std::abs(b.point.theta - e.theta));
    JacobiFields f = fields_of(b, h * (i + 1));
    f.index = index_of(f.fields, zeros, largest_turn < kStraight);
    visit(f);
    a = b;
  }
}

}  // namespace

JacobiFields end_map(const Elastica& elastica) {
  JacobiFields last;
  run(elastica, 1, [&last](const JacobiFields& f) { last = f; });
  return last;
}

std::vector<JacobiFields> jacobi_fields(const Elastica& elastica, int at_least) {
  std::vector<JacobiFields> all;
  run(elastica, std::max(1, at_least), [&all](const JacobiFields& f) { all.push_back(f); });
  return all;
}

}  // namespace hotblade::elastica
