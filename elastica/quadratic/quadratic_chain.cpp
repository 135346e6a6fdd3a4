#include "elastica/quadratic/quadratic_chain.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "elastica/curve/features.hpp"
#include "elastica/linear/cross.hpp"

namespace hotblade::elastica {
namespace {

using Eigen::Vector2d;

// Through both points with their tangents; a straight one where the tangents do not meet ahead.
Quadratic touching(const CurvePoint& a, const CurvePoint& b) {
  const Vector2d p = a.position(), q = b.position(), chord = q - p, t = a.tangent(), u = b.tangent();
  const double turn = cross(t, u), ahead = cross(chord, u) / turn, behind = cross(t, chord) / turn;
  const double far = chord.norm();
  const bool meet = ahead > 0 && behind > 0 && ahead < far && behind < far;
  return {p, meet ? Vector2d(p + ahead * t) : Vector2d(p + 0.5 * chord), q};
}

// s(u) with s(0) = 0, s(1) = length and the speeds of the quadratic at its ends.
struct Pace {
  double length, first, last;  // s' at 0 and 1
  [[nodiscard]] double b() const { return 3 * length - 2 * first - last; }
  [[nodiscard]] double c() const { return first + last - 2 * length; }
  [[nodiscard]] double at(double u) const { return ((c() * u + b()) * u + first) * u; }
  [[nodiscard]] double d1(double u) const { return (3 * c() * u + 2 * b()) * u + first; }
  [[nodiscard]] double d2(double u) const { return 6 * c() * u + 2 * b(); }
  [[nodiscard]] double d3() const { return 6 * c(); }
  // Of |s'| and |s''| over [0, 1], by Bernstein coefficients and the ends.
  [[nodiscard]] double most_d1() const {
    return std::max({std::abs(first), std::abs(first + b()), std::abs(last)});
  }
  [[nodiscard]] double most_d2() const { return std::max(std::abs(d2(0)), std::abs(d2(1))); }
};

// How far the quadratic of [s0, s1] and that piece of the elastica can be from each other.
double deviation(const ElasticaCurve& curve, const Quadratic& q, double s0, double s1) {
  constexpr int kSamples = 16;
  constexpr double kStep = 1.0 / kSamples;
  const Elastica& e = curve.elastica();
  const Vector2d q2 = 2 * (q[2] - 2 * q[1] + q[0]);
  const Pace pace{s1 - s0, 2 * (q[1] - q[0]).norm(), 2 * (q[2] - q[1]).norm()};
  double most = 0, most_d2 = 0, most_kappa = 0;
  for (int i = 0; i <= kSamples; ++i) {
    const double u = i * kStep, v = pace.d1(u);
    const CurvePoint p = curve.at(std::clamp(s0 + pace.at(u), s0, s1));
    const Vector2d t = p.tangent(), n(-t.y(), t.x());
    most = std::max(most, (point_at(q, u) - p.position()).norm());
    most_d2 = std::max(most_d2, (q2 - p.kappa * v * v * n - pace.d2(u) * t).norm());
    most_kappa = std::max(most_kappa, std::abs(p.kappa));
  }
  const double tension = std::hypot(e.lambda1, e.lambda2), v = pace.most_d1();
  // |kappa'| <= |lambda|; half a step from the nearest sample.
  const double kappa = most_kappa + 0.5 * kStep * v * tension;
  const double d3 =
      kappa * kappa * v * v * v + tension * v * v * v + 3 * kappa * v * pace.most_d2() + std::abs(pace.d3());
  return most + kStep * kStep / 8 * (most_d2 + 0.5 * kStep * d3);
}

// Whether s grows all along, so that every point of the piece has a partner.
bool runs_forward(const Quadratic& q, double length) {
  const Pace pace{length, 2 * (q[1] - q[0]).norm(), 2 * (q[2] - q[1]).norm()};
  return pace.first >= 0 && pace.last >= 0 && pace.first + pace.b() >= 0;
}

}  // namespace

QuadraticChain quadratic_chain(const Elastica& e, double tolerance) {
  if (!(tolerance > 0)) throw std::logic_error("quadratic_chain needs a tolerance above 0");
  const ElasticaCurve curve(e);
  constexpr double kLeastShare = 1e-12;  // the curve's own points are no better
  tolerance = std::max(tolerance, kLeastShare * e.length);
  // A piece that begins or ends in an inflection has one curvature's sign, and tangents that meet ahead.
  std::vector<double> stops = inflections(e);
  stops.push_back(e.length);
  QuadraticChain chain;
  chain.arc_length.push_back(0);
  // A radian a piece at most: tangents of half a turn do not meet.
  const double sharpest = curve.max_abs_curvature();
  double step = sharpest * e.length > 1 ? 1 / sharpest : e.length;
  std::size_t stop = 0;
  for (double s = 0; s < e.length || chain.pieces.empty();) {
    while (stop + 1 < stops.size() && stops[stop] <= s) ++stop;
    const double left = stops[stop] - s;
    // What is left in equal steps, so that no sliver stays.
    const double next = left > step ? s + left / std::ceil(left / step) : stops[stop];
    const Quadratic q = touching(curve.at(s), curve.at(next));
    // Both lie within the piece's length of its start.
    const double off = runs_forward(q, next - s) ? deviation(curve, q, s, next) : next - s;
    constexpr double kShortest = 1e-9;  // of the length: a step that rounding alone refuses
    if (off > tolerance && next - s > kShortest * e.length) {
      step = (next - s) * std::clamp(0.9 * std::sqrt(std::sqrt(tolerance / off)), 0.2, 0.9);
      continue;
    }
    chain.pieces.push_back(q);
    chain.arc_length.push_back(next);
    chain.bound = std::max(chain.bound, off);
    // The fourth root of what the tolerance leaves.
    step = (next - s) *
           std::clamp(0.9 * std::sqrt(std::sqrt(tolerance / std::max(off, 1e-3 * tolerance))), 1.0, 4.0);
    if (sharpest > 0) step = std::min(step, 1 / sharpest);
    s = next;
  }
  return chain;
}

}  // namespace hotblade::elastica
