#include "elastica/curve/elastica.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace hotblade::elastica {

namespace {

bool finite(const Elastica& e) {
  for (const double v : {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length}) {
    if (!std::isfinite(v)) return false;
  }
  return true;
}

// Pieces of equal length, none longer than the series can carry.
int piece_count(const Elastica& e) {
  const double pieces = std::ceil(turns_at_most(e, e.length) / kStepOmega);
  if (!(pieces <= ElasticaCurve::kMaxPieces)) {
    throw std::logic_error("elastica winds too tightly for its length to be evaluated");
  }
  return std::max(1, static_cast<int>(pieces));
}

using Pair = Eigen::Array2d;

// taylor.hpp's series with every cos and sin coefficient of order k divided by k + 1: those of x and y, and
// no divisions in evaluations, of which a curve sees hundreds.
TaylorPiece<double> expand_divided(const CurvePoint& start, double lambda1, double lambda2) {
  constexpr std::size_t kOrder = kTaylorOrder;
  TaylorPiece<double> piece;
  std::array<Pair, kOrder + 1> turned;  // (-sin theta, cos theta), which both sums need
  std::array<double, kOrder + 2> rate;  // (j + 1) times coefficient j + 1 of theta
  turned[0] = {-std::sin(start.theta), std::cos(start.theta)};
  rate[0] = start.kappa;
  piece.t[0] = start.theta;
  const Pair force(lambda1, lambda2);
  // Unrolled: the ends of eighteen loops of different lengths would be guessed wrong.
#pragma GCC unroll 32
  for (std::size_t k = 0; k <= kOrder; ++k) {
    const double inverse = 1.0 / static_cast<double>(k + 1);
    piece.c[k] = turned[k][1] * inverse;
    piece.s[k] = -turned[k][0] * inverse;
    piece.t[k + 1] = rate[k] * inverse;
    rate[k + 1] = (turned[k] * force).sum() * inverse;
    if (k == kOrder) break;
    // Two sums side by side, the newest terms last: neither waits for itself or for the order before.
    Pair even = Pair::Zero(), odd = Pair::Zero();
#pragma GCC unroll 32
    for (std::size_t j = 1; j < k; ++j) (j % 2 == 0 ? even : odd) += rate[j] * turned[k - j];
    even += rate[k] * turned[0];
    if (k > 0) odd += rate[0] * turned[k];
    const Pair d = (even + odd) * inverse;  // (cos, sin) of order k + 1
    turned[k + 1] = {-d[1], d[0]};
  }
  return piece;
}

// Sum of coefficient k times h^k, k = 0 .. kTaylorOrder: even and odd powers side by side in h^2, which
// halves the chain of operations that wait for each other and loads the coefficients as they lie.
template <typename CoefficientPair>
double power_sum(const CoefficientPair& pair, double last, double h) {
  static_assert(kTaylorOrder % 2 == 0, "the last power is even");
  const double h2 = h * h;
  Pair sum(last, 0);
#pragma GCC unroll 32
  for (std::size_t k = kTaylorOrder; k >= 2; k -= 2) sum = sum * h2 + pair(k - 2);
  return sum[0] + h * sum[1];
}

// At distance h from the piece's start, the start being at (0, 0).
CurvePoint evaluate_divided(const TaylorPiece<double>& p, double h) {
  constexpr std::size_t kLast = kTaylorOrder;
  const auto plain = [](const double* coefficients) {
    return [coefficients](std::size_t k) -> Pair { return Eigen::Map<const Pair>(coefficients + k); };
  };
  const auto rate = [&p](std::size_t k) -> Pair {
    const auto order = static_cast<double>(k);
    return Eigen::Map<const Pair>(p.t + k + 1) * Pair(order + 1, order + 2);
  };
  return {h * power_sum(plain(p.c), p.c[kLast], h), h * power_sum(plain(p.s), p.s[kLast], h),
          power_sum(plain(p.t), p.t[kLast], h), power_sum(rate, (kLast + 1.0) * p.t[kLast + 1], h)};
}

// Reversing the sense of travel turns the tangent and flips curvature and forces.
Elastica turned(const Elastica& e, const CurvePoint& start) {
  return {start.x, start.y, start.theta + std::numbers::pi, -start.kappa, -e.lambda1, -e.lambda2, e.length};
}

}  // namespace

Eigen::Vector2d CurvePoint::tangent() const {
  return {std::cos(theta), std::sin(theta)};
}

double turns_at_most(const Elastica& e, double length) {
  return length * taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2);
}

ElasticaCurve::ElasticaCurve(const Elastica& elastica) : elastica_(elastica) {
  if (!finite(elastica) || elastica.length < 0) {
    throw std::logic_error("elastica parameters must be finite and the length not negative");
  }
  const int n = piece_count(elastica);
  step_ = elastica.length / n;
  pieces_.reserve(static_cast<std::size_t>(n));
  CurvePoint start{elastica.x, elastica.y, elastica.theta, elastica.kappa};
  for (int i = 0; i < n; ++i) {
    pieces_.push_back({expand_divided(start, elastica.lambda1, elastica.lambda2), start.x, start.y});
    const CurvePoint end = evaluate_divided(pieces_.back().series, step_);
    start = {start.x + end.x, start.y + end.y, end.theta, end.kappa};
  }
}

CurvePoint ElasticaCurve::at(double s) const {
  s = std::clamp(s, 0.0, elastica_.length);
  const auto last = pieces_.size() - 1;
  const auto i = step_ > 0 ? std::min(last, static_cast<std::size_t>(s / step_)) : 0;
  const Piece& piece = pieces_[i];
  const CurvePoint p = evaluate_divided(piece.series, s - static_cast<double>(i) * step_);
  return {piece.x0 + p.x, piece.y0 + p.y, p.theta, p.kappa};
}

double ElasticaCurve::max_abs_curvature() const {
  const CurvePoint end = at(elastica_.length);
  const double ends = std::max(std::abs(elastica_.kappa), std::abs(end.kappa));
  const double l1 = elastica_.lambda1, l2 = elastica_.lambda2, force = std::hypot(l1, l2);
  if (!(force > 0)) return ends;
  // Turns of theta past the force's angle. |kappa| peaks there, so no inflection lies within a piece of the
  // passage, and a piece passes the angle exactly when its ends lie on different sides.
  const double angle = std::atan2(l2, l1);
  const auto turns = [&](double theta) { return std::floor((theta - angle) / (2 * std::numbers::pi)); };
  double before = turns(elastica_.theta);
  for (const Piece& piece : pieces_) {
    const double after = turns(&piece == &pieces_.back() ? end.theta : (&piece + 1)->series.t[0]);
    if (after != before) {
      const double along = l1 * std::cos(elastica_.theta) + l2 * std::sin(elastica_.theta);
      return std::max(ends, std::sqrt(elastica_.kappa * elastica_.kappa + 2 * (force - along)));
    }
    before = after;
  }
  return ends;
}

std::vector<CurvePoint> sample(const Elastica& elastica, int n) {
  if (n < 2) throw std::logic_error("sample needs at least 2 points");
  const ElasticaCurve curve(elastica);
  std::vector<CurvePoint> points;
  points.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) points.push_back(curve.at(elastica.length * i / (n - 1)));
  return points;
}

CurvePoint point_at(const Elastica& elastica, double s) {
  Elastica e = elastica;
  e.length = std::abs(s);
  if (s >= 0) return ElasticaCurve(e).at(s);
  CurvePoint p = ElasticaCurve(turned(e, {e.x, e.y, e.theta, e.kappa})).at(-s);
  p.theta -= std::numbers::pi;
  p.kappa = -p.kappa;
  return p;
}

Elastica segment(const Elastica& elastica, double s0, double s1) {
  if (!(s1 >= s0)) throw std::logic_error("segment ends before it starts");
  const CurvePoint p = point_at(elastica, s0);
  return {p.x, p.y, p.theta, p.kappa, elastica.lambda1, elastica.lambda2, s1 - s0};
}

Elastica reversed(const Elastica& elastica) {
  return turned(elastica, point_at(elastica, elastica.length));
}

}  // namespace hotblade::elastica
