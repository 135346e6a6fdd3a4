#include "pipeline/plan/planned_ribs.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "elastica/bezier/curve_distance.hpp"
#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/curve/placement.hpp"
#include "elastica/fit/bezier_spline.hpp"
#include "pipeline/verify/refusal.hpp"

namespace hotblade::pipeline {

namespace {

Eigen::Vector2d to_frame(const Eigen::Vector2d& q, const Eigen::Vector2d& origin, const Eigen::Vector2d& x) {
  const Eigen::Vector2d d = q - origin;
  return {d.dot(x), x.x() * d.y() - x.y() * d.x()};
}

// Parameter at which a share of the curve's length has passed.
double parameter_at(const elastica::Bezier& bezier, double share) {
  constexpr int kPieces = 256;
  const std::vector<double> passed = elastica::arc_lengths(bezier, kPieces);
  const double wanted = share * passed.back();
  const auto next = std::clamp<std::ptrdiff_t>(
      std::lower_bound(passed.begin(), passed.end(), wanted) - passed.begin(), 1, kPieces);
  const double from = passed[static_cast<std::size_t>(next - 1)], to = passed[static_cast<std::size_t>(next)];
  return (static_cast<double>(next - 1) + (to > from ? (wanted - from) / (to - from) : 0)) / kPieces;
}

// The part between two parameters, by blossoming.
elastica::Bezier part_of(const elastica::Bezier& b, double t0, double t1) {
  const auto blossom = [&](double r, double s, double t) -> Eigen::Vector2d {
    const auto mix = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q, double u) -> Eigen::Vector2d {
      return p + u * (q - p);
    };
    const Eigen::Vector2d p0 = mix(b[0], b[1], r), p1 = mix(b[1], b[2], r), p2 = mix(b[2], b[3], r);
    return mix(mix(p0, p1, s), mix(p1, p2, s), t);
  };
  return {blossom(t0, t0, t0), blossom(t0, t0, t1), blossom(t0, t1, t1), blossom(t1, t1, t1)};
}

// What the design says of a rib that goes on past its border, curves and all: templates and files show that.
RibFit design_part(const RibFit& fit) {
  if (fit.course.empty()) return fit;
  RibFit part = fit;
  part.course.clear();
  if (fit.target.empty()) {
    part.target = fit.course;
    part.deviation_mm = elastica::max_distance(part.target, part.elastica);
    return part;
  }
  const double length = fit.elastica.length;
  part.elastica = segment(fit.elastica, fit.own.first * length, fit.own.last * length);
  part.bezier =
      part_of(fit.bezier, parameter_at(fit.bezier, fit.own.first), parameter_at(fit.bezier, fit.own.last));
  const elastica::LambdaResidual residual = elastica::lambda_residual(part.bezier);
  if (has_value(residual.status)) part.lambda_residual = residual.value;
  part.deviation_mm = elastica::max_distance(part.target, part.elastica);
  return part;
}

// The fit's cubic where that is near the elastica, as few as are where it is not.
void set_bezier(const elastica::Bezier& one, double residual, double near_mm, Rib& rib) {
  constexpr double kBounds = 0.05;  // of the distance
  rib.bezier.assign(one.begin(), one.end());
  rib.lambda_residual = residual;
  if (hausdorff(one, rib.elastica, kBounds * near_mm).upper <= near_mm) return;
  rib.bezier.resize(1);
  rib.lambda_residual = 0;
  for (const elastica::Bezier& piece : elastica::bezier_spline(rib.elastica, near_mm)) {
    rib.bezier.front() = rib.bezier.size() == 1 ? piece[0] : rib.bezier.front();
    rib.bezier.insert(rib.bezier.end(), piece.begin() + 1, piece.end());
    const elastica::LambdaResidual r = elastica::lambda_residual(piece);
    if (has_value(r.status)) rib.lambda_residual = std::max(rib.lambda_residual, r.value);
  }
}

// A rib in its own frame: origin at its first end, x towards its last, y to the waste side.
Rib make_rib(const RibFit& whole, const StripPlan& strip, const std::string& id, double tolerance_mm) {
  const RibFit fit = design_part(whole);
  Rib rib;
  rib.id = id;
  const Eigen::Vector2d origin = fit.target.front();
  const Eigen::Vector2d x = (fit.target.back() - origin).normalized();
  const Frame plane = strip.plane(fit.offset_mm);
  rib.frame.origin = plane.point(origin.x(), origin.y());
  rib.frame.x = x.x() * plane.x + x.y() * plane.y;
  rib.frame.y = -x.y() * plane.x + x.x() * plane.y;
  for (const Eigen::Vector2d& q : fit.target) rib.target.push_back(to_frame(q, origin, x));
  elastica::Elastica shifted = fit.elastica;
  shifted.x -= origin.x();
  shifted.y -= origin.y();
  Eigen::Isometry2d turn = Eigen::Isometry2d::Identity();
  turn.linear() << x.x(), x.y(), -x.y(), x.x();
  rib.elastica = elastica::transformed(shifted, turn);
  rib.elastica.theta = std::remainder(rib.elastica.theta, 2 * std::numbers::pi);
  elastica::Bezier one;
  for (std::size_t i = 0; i < one.size(); ++i) one[i] = to_frame(fit.bezier[i], origin, x);
  set_bezier(one, fit.lambda_residual, kBezierShare * tolerance_mm, rib);
  rib.design_deviation_mm = fit.deviation_mm;
  return rib;
}

}  // namespace

Strip make_strip(const StripPlan& plan, std::vector<BladePose> poses, double tolerance_mm) {
  Strip strip;
  strip.id = plan.id;
  strip.blade_length_mm = plan.blade_length_mm;
  strip.design_to_cell = plan.design_to_cell;
  strip.block = plan.block;
  for (std::size_t i = 0; i < plan.ribs.size(); ++i) {
    strip.ribs.push_back(make_rib(plan.ribs[i], plan, rib_id(plan.id, i), tolerance_mm));
  }
  poses.shrink_to_fit();  // of hundreds of strips: as much again
  strip.poses = std::move(poses);
  return strip;
}

}  // namespace hotblade::pipeline
