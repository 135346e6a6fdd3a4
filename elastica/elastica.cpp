#include "elastica/elastica.hpp"

#include <algorithm>
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
  const double omega = taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2);
  const double pieces = std::ceil(e.length * omega / kStepOmega);
  if (!(pieces <= ElasticaCurve::kMaxPieces)) {
    throw std::logic_error("elastica winds too tightly for its length to be evaluated");
  }
  return std::max(1, static_cast<int>(pieces));
}

// Reversing the sense of travel turns the tangent and flips curvature and forces.
Elastica turned(const Elastica& e, const CurvePoint& start) {
  return {start.x, start.y, start.theta + std::numbers::pi, -start.kappa, -e.lambda1, -e.lambda2, e.length};
}

}  // namespace

Eigen::Vector2d CurvePoint::tangent() const {
  return {std::cos(theta), std::sin(theta)};
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
    pieces_.push_back(
        {expand(start.theta, start.kappa, elastica.lambda1, elastica.lambda2), start.x, start.y});
    const TaylorPoint<double> end = evaluate(pieces_.back().series, step_);
    start = {start.x + end.x, start.y + end.y, end.theta, end.kappa};
  }
}

CurvePoint ElasticaCurve::at(double s) const {
  s = std::clamp(s, 0.0, elastica_.length);
  const auto last = pieces_.size() - 1;
  const auto i = step_ > 0 ? std::min(last, static_cast<std::size_t>(s / step_)) : 0;
  const TaylorPoint<double> p = evaluate(pieces_[i].series, s - static_cast<double>(i) * step_);
  return {pieces_[i].x0 + p.x, pieces_[i].y0 + p.y, p.theta, p.kappa};
}

double ElasticaCurve::max_abs_curvature() const {
  double largest = std::max(std::abs(at(0).kappa), std::abs(at(elastica_.length).kappa));
  // |kappa| peaks inside where kappa' = -lambda1 sin + lambda2 cos changes sign; bisect each bracket. A piece
  // turns by at most kStepOmega rad, so it holds at most one such point unless it straddles an inflection,
  // where the quarter-steps below separate them.
  const auto slope = [this](double s) {
    const double theta = at(s).theta;
    return elastica_.lambda2 * std::cos(theta) - elastica_.lambda1 * std::sin(theta);
  };
  const double h = step_ / 4;
  for (std::size_t i = 0; i < 4 * pieces_.size(); ++i) {
    double a = static_cast<double>(i) * h, b = a + h;
    double fa = slope(a);
    if (fa * slope(b) > 0) continue;
    for (int k = 0; k < 40; ++k) {
      const double m = 0.5 * (a + b), fm = slope(m);
      if (fa * fm > 0) {
        a = m;
        fa = fm;
      } else {
        b = m;
      }
    }
    largest = std::max(largest, std::abs(at(0.5 * (a + b)).kappa));
  }
  return largest;
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
