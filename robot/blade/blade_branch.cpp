#include "robot/blade/blade_branch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "elastica/blade/continuation.hpp"
#include "elastica/blade/stability.hpp"
#include "elastica/blade/taut.hpp"
#include "robot/pose/flat_arc.hpp"

namespace hotblade::robot {

namespace {

using elastica::Elastica;
using elastica::PlanarPose;

// Register rounding and the like: a shape at the limit itself is not beyond it.
constexpr double kCurvatureSlack = 1e-4;

// The flat arc of waypoint 0, if clamp B stands as one would have it.
std::optional<Elastica> flat_arc(double x, double y, double theta, double length) {
  const double u = 0.5 * theta;
  if (!(std::abs(u) >= kFlatArcLeastHalfTurn_rad - kFlatArcAngleSlack_rad &&
        std::abs(u) <= kFlatArcMostHalfTurn_rad + kFlatArcAngleSlack_rad))
    return std::nullopt;
  if (!(std::abs(std::atan2(y, x) - u) <= kFlatArcAngleSlack_rad)) return std::nullopt;
  if (!(std::abs(std::hypot(x, y) - length * std::sin(u) / u) <= kFlatArcChordSlack * length))
    return std::nullopt;
  return Elastica{0, 0, 0, 2 * u / length, 0, 0, length};
}

// A nearly straight blade between clamps whose directions differ from the chord's by ta and tb, without force
// along the chord: its curvature is linear, kappa = (-4 ta - 2 tb) / l + 6 (ta + tb) s / l^2, up to squares
// of the angles, which are below 1e-5 where it is used.
struct Relaxed {
  Elastica shape;
  double shortening_mm = 0;  // of the chord against the length: l (2 ta^2 - ta tb + 2 tb^2) / 30
};

Relaxed relaxed(double x, double y, double theta, double length) {
  const double ta = -std::atan2(y, x), tb = theta + ta;
  const double across = 6 * (ta + tb) / (length * length);
  return {{0, 0, 0, (-4 * ta - 2 * tb) / length, std::sin(ta) * across, std::cos(ta) * across, length},
          length * (2 * ta * ta - ta * tb + 2 * tb * tb) / 30};
}

}  // namespace

RelativeClamp seen_from_a(const ClampPoses& clamps, double near_rad) {
  const auto& [a, b] = clamps;
  const Eigen::Matrix3d to_a = a.q.toRotationMatrix().transpose();
  const Eigen::Vector3d d = to_a * (b.p - a.p);
  const Eigen::Vector3d tangent = to_a * (b.q * Eigen::Vector3d::UnitX());
  const Eigen::Vector3d normal = to_a * (b.q * Eigen::Vector3d::UnitZ());
  const double theta = std::atan2(tangent.y(), tangent.x());
  const double nearest = near_rad + std::remainder(theta - near_rad, 2 * std::numbers::pi);
  return {{d.x(), d.y(), nearest}, std::max(std::abs(d.z()), d.norm() * normal.head<2>().norm())};
}

double bend_between(const Elastica& p, const Elastica& q) {
  const double l = p.length;
  return std::abs(p.kappa - q.kappa) * l +
         0.5 * (std::abs(p.lambda1 - q.lambda1) + std::abs(p.lambda2 - q.lambda2)) * l * l;
}

double curvature_bound(const Elastica& e) {
  const double force = std::hypot(e.lambda1, e.lambda2);
  const double along = e.lambda1 * std::cos(e.theta) + e.lambda2 * std::sin(e.theta);
  return std::sqrt(e.kappa * e.kappa + 2 * std::max(0.0, force - along));
}

BladeBranch::BladeBranch(const Elastica& known, const BladeLimits& limits)
    : limits_(limits),
      length_mm_(known.length),
      started_(true),
      shape_(known),
      theta_(elastica::clamps_of(known).b.theta) {}

BladeFinding BladeBranch::lose(Limit limit, double value, double bound) {
  return lost_ = {limit, value, bound};
}

BladeFinding BladeBranch::move_to(const Pose& a, const Pose& b) {
  if (lost()) return lost_;
  const auto [to, off_plane_mm] = seen_from_a({a, b}, theta_);
  if (!(off_plane_mm <= limits_.off_plane_mm))
    return {Limit::kBladePlane, off_plane_mm, limits_.off_plane_mm};
  if (!started_) {
    if (const BladeFinding first = start(to); !first.held()) return first;
  }
  if (const BladeFinding bent = bend_to(to); !bent.held()) return bent;
  theta_ = to.theta;
  off_plane_mm_ = off_plane_mm;
  return check_limits();
}

BladeFinding BladeBranch::start(const PlanarPose& b) {
  const auto arc = flat_arc(b.x, b.y, b.theta, length_mm_);
  if (!arc) return {Limit::kStartPose, 0.5 * std::abs(b.theta), kFlatArcMostHalfTurn_rad};
  shape_ = *arc;
  followed_ = {};
  started_ = true;
  return {};
}

BladeFinding BladeBranch::bend_to(const PlanarPose& b) {
  const double chord = std::hypot(b.x, b.y);
  if (chord >= elastica::kTautChord * length_mm_ - limits_.rounding_mm) return pull_taut(b, chord);
  const elastica::ClampPair to{{0, 0, 0}, b};
  // From a straight blade the clamps' turn picks the side.
  const Elastica from = taut_ ? relaxed(b.x, b.y, b.theta, length_mm_).shape : shape_;
  const bool end_known = !taut_ && followed_.elastica.length > 0;
  taut_ = false;
  return follow_by(end_known ? elastica::follow_on(followed_, to) : elastica::follow(from, to), b);
}

BladeFinding BladeBranch::follow_by(const elastica::FollowReport& way, const PlanarPose& b) {
  followed_ = way.shape;
  shape_ = way.shape.elastica;
  if (way.status == elastica::FollowStatus::kFollowed) return {};
  if (way.status == elastica::FollowStatus::kOutOfReach)
    return lose(Limit::kBladeReach, std::hypot(b.x, b.y), length_mm_);
  return lose(Limit::kBladeSnap, elastica::stability_margin(shape_), limits_.min_margin);
}

// What the blade would have to be stretched by stays within what the clamps' positions are known to.
BladeFinding BladeBranch::pull_taut(const PlanarPose& b, double chord) {
  const Relaxed straight = relaxed(b.x, b.y, b.theta, length_mm_);
  const double slack = (1 - elastica::kTautChord) * length_mm_ + limits_.rounding_mm;
  if (!(chord <= length_mm_ + slack)) return lose(Limit::kBladeReach, chord, length_mm_);
  const double wanted = chord + straight.shortening_mm;
  constexpr double kStretch = 4;  // times the slack: a blade under tension is shorter than a relaxed one
  if (!(wanted <= length_mm_ + kStretch * slack)) return lose(Limit::kBladeReach, wanted, length_mm_);
  shape_ = straight.shape;
  followed_ = {};
  taut_ = true;
  return {};
}

double BladeBranch::exact_margin() {
  if (poses_since_margin_ == 0) return margin_;
  margin_ = margin_shape_.length > 0 ? elastica::stability_margin(shape_, margin_)
                                     : elastica::stability_margin(shape_);
  margin_shape_ = shape_;
  poses_since_margin_ = 0;
  return margin_;
}

double BladeBranch::largest_curvature_per_mm() const {
  return elastica::ElasticaCurve(shape_).max_abs_curvature();
}

// Whether the shape for which the margin was computed, and what may have become of it since, says that one
// that is bent by so much more keeps the margin.
bool BladeBranch::margin_holds(double more_bend) const {
  const double force = std::hypot(shape_.lambda1, shape_.lambda2) * length_mm_ * length_mm_;
  const double drop = kMarginPerBend * (1 + 0.1 * force) * (bend_between(shape_, margin_shape_) + more_bend);
  return margin_ - drop >= limits_.min_margin && limits_.min_margin <= kMarginBoundHolds;
}

bool BladeBranch::far_from_limits(const Pose& a, const Pose& b) const {
  if (lost() || taut_ || !(followed_.elastica.length > 0)) return false;
  const PlanarPose to = seen_from_a({a, b}, theta_).b;
  if (std::hypot(to.x, to.y) >= elastica::kTautChord * length_mm_ - limits_.rounding_mm) return false;
  const elastica::CurvePoint& end = followed_.end.point;
  const Eigen::Vector3d way(to.x / length_mm_ - end.x, to.y / length_mm_ - end.y, to.theta - end.theta);
  const Eigen::Vector3d unknowns = followed_.end.fields.inverse() * way;
  const double by_clamps = std::abs(unknowns[0]) + 0.5 * (std::abs(unknowns[1]) + std::abs(unknowns[2]));
  // A step of the branch bends by as much from the first order (elastica/blade/continuation.cpp), or is
  // halved.
  constexpr double kBend = 1.2, kSmall = 1e-3;
  const double bend = kBend * by_clamps + kSmall;
  // Along a blade kappa = kappa0 - lambda1 y + lambda2 x: by a bend b its curvature times its length changes
  // by up to 2 b for what its start and its force do, and by force times length^2 for each length that its
  // points move by, which is b / 2 at most.
  const double force = std::hypot(shape_.lambda1, shape_.lambda2) * length_mm_ * length_mm_;
  const double curvature = curvature_bound(shape_) + (2 + 0.5 * force) * bend / length_mm_;
  return curvature <= limits_.max_curvature_per_mm && margin_holds(bend);
}

BladeFinding BladeBranch::check_limits() {
  ++poses_since_margin_;
  const bool first = margin_shape_.length <= 0;
  if (first || poses_since_margin_ >= limits_.margin_every || !margin_holds(0)) exact_margin();
  const double most = limits_.max_curvature_per_mm * (1 + kCurvatureSlack);
  if (!(curvature_bound(shape_) <= most)) {
    const double curvature = largest_curvature_per_mm();
    if (!(curvature <= most)) return {Limit::kBladeYield, 1 / curvature, 1 / limits_.max_curvature_per_mm};
  }
  if (!(margin_ >= limits_.min_margin)) return {Limit::kBladeMargin, margin_, limits_.min_margin};
  return {};
}

}  // namespace hotblade::robot
