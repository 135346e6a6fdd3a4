#include "elastica/bezier/curve_distance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "elastica/kernels/hausdorff_search.hpp"

namespace hotblade::elastica {

namespace {

using hausdorff_search::Point;

struct BezierSide {
  const Bezier& b;

  [[nodiscard]] Point at(double u) const {
    const BezierPoint q = evaluate(b, u);
    return {u, q.p, q.d1, q.d2};
  }
  // The second derivative is affine, so its norm is largest at an end.
  [[nodiscard]] static double bend(const Point& a, const Point& c) {
    return std::max(a.d2.norm(), c.d2.norm());
  }
};

struct ElasticaSide {
  ElasticaCurve curve;
  double length, tension;

  explicit ElasticaSide(const Elastica& e)
      : curve(e), length(e.length), tension(std::hypot(e.lambda1, e.lambda2)) {}
  [[nodiscard]] Point at(double u) const {
    const CurvePoint q = curve.at(u * length);
    const Eigen::Vector2d t = q.tangent();
    return {u, q.position(), length * t, length * length * q.kappa * Eigen::Vector2d(-t.y(), t.x())};
  }
  // |kappa'| <= |lambda|.
  [[nodiscard]] double bend(const Point& a, const Point& c) const {
    const double slack = tension * length * length * length * std::abs(c.u - a.u);
    return 0.5 * (a.d2.norm() + c.d2.norm() + slack);
  }
};

}  // namespace

HausdorffBounds hausdorff(const Bezier& b, const Elastica& e, double tolerance) {
  if (!(tolerance > 0)) throw std::logic_error("hausdorff needs a tolerance above 0");
  const BezierSide bezier{b};
  const ElasticaSide elastica(e);
  const auto range = hausdorff_search::both_ways(bezier, elastica, tolerance);
  return {range.lower, range.upper};
}

CurveDistance distance(const Bezier& b, const Elastica& e) {
  constexpr int kSamples = 200;
  const std::vector<double> t = even_parameters(b, kSamples + 1);
  const double length = arc_lengths(b, 64).back();
  const ElasticaCurve curve(e);
  double l2 = 0, angle2 = 0;
  for (int i = 0; i <= kSamples; ++i) {
    const BezierPoint p = evaluate(b, t[static_cast<std::size_t>(i)]);
    const CurvePoint q = curve.at(e.length * i / kSamples);
    const double weight = (i == 0 || i == kSamples ? 1 : i % 2 ? 4 : 2) / (3.0 * kSamples);  // Simpson
    l2 += weight * (p.p - q.position()).squaredNorm() / (length * length);
    const double turn = std::remainder(std::atan2(p.d1.y(), p.d1.x()) - q.theta, 2 * std::numbers::pi);
    angle2 += weight * turn * turn;
  }
  constexpr double kHausdorffShare = 1e-6;  // far below what any blade or mesh resolves
  const HausdorffBounds h = hausdorff(b, e, kHausdorffShare * length);
  return {std::sqrt(l2), std::sqrt(l2 + angle2), h.upper, h.upper - h.lower};
}

}  // namespace hotblade::elastica
