#include "pipeline/branch.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "elastica/continuation.hpp"
#include "elastica/stability.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::Elastica;

// Everything below is seen from clamp A: it stands at the origin, its tangent along x.
struct Relative {
  double x = 0, y = 0, theta = 0;  // of clamp B
  double off_plane_mm = 0;         // of clamp B, its normal's tilt counted over the chord
};

Relative relative(const BladePose& pose, double theta_before) {
  const Eigen::Matrix3d to_a = pose.a.q.toRotationMatrix().transpose();
  const Eigen::Vector3d d = to_a * (pose.b.p - pose.a.p);
  const Eigen::Vector3d tangent = to_a * (pose.b.q * Eigen::Vector3d::UnitX());
  const Eigen::Vector3d normal = to_a * (pose.b.q * Eigen::Vector3d::UnitZ());
  const double theta = std::atan2(tangent.y(), tangent.x());
  // Between waypoints a clamp turns by far less than half a turn.
  const double unwrapped = theta_before + std::remainder(theta - theta_before, 2 * std::numbers::pi);
  return {d.x(), d.y(), unwrapped, std::max(std::abs(d.z()), d.norm() * normal.head<2>().norm())};
}

Elastica seen_from_a(const Elastica& e) {
  const double c = std::cos(e.theta), s = std::sin(e.theta);
  return {0, 0, 0, e.kappa, c * e.lambda1 + s * e.lambda2, c * e.lambda2 - s * e.lambda1, e.length};
}

double distance_mm(const Elastica& p, const Elastica& q) {
  constexpr int kPoints = 9;
  const auto a = elastica::sample(p, kPoints), b = elastica::sample(q, kPoints);
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, (a[i].position() - b[i].position()).norm());
  return largest;
}

// The flat arc of waypoint 0, if it is one.
std::optional<Elastica> flat_arc(const Relative& b, double length) {
  constexpr double kLeast = 0.10, kMost = 0.17;  // rad, docs/controller-protocol.md
  // As the controller allows: far below what a second stable shape would need, far above rounding.
  constexpr double kAngleSlack = 1e-3, kChordSlack = 1e-4;
  const double u = 0.5 * b.theta;
  if (std::abs(u) < kLeast - kAngleSlack || std::abs(u) > kMost + kAngleSlack) return std::nullopt;
  if (std::abs(std::atan2(b.y, b.x) - u) > kAngleSlack) return std::nullopt;
  if (std::abs(std::hypot(b.x, b.y) - length * std::sin(u) / u) > kChordSlack * length) return std::nullopt;
  return Elastica{0, 0, 0, 2 * u / length, 0, 0, length};
}

// Chord over length from which the blade is straight but for less than its thickness or so: the equations for
// its force become singular, and its shape is a straight line whatever the force.
constexpr double kTaut = 1 - 1e-6;

class Follower {
 public:
  Follower(const Strip& strip, const BranchOptions& options) : strip_(strip), options_(options) {}

  BranchReport run() {
    report_.smallest_margin = std::numeric_limits<double>::infinity();
    if (!start()) return report_;
    for (std::size_t i = 0; i < strip_.poses.size(); ++i) {
      if (!reach(i) || !compare(i) || !check_limits(i)) return report_;
    }
    return report_;
  }

 private:
  bool stop(BranchStatus status, std::size_t pose, double value, double bound) {
    report_.status = status;
    report_.pose = pose;
    report_.value = value;
    report_.bound = bound;
    return false;
  }

  bool start() {
    const Relative b = relative(strip_.poses.front(), 0);
    const auto arc = flat_arc(b, strip_.blade_length_mm);
    if (!arc) return stop(BranchStatus::kNoFlatArc, 0, 0.5 * std::abs(b.theta), 0.17);
    shape_ = *arc;
    theta_ = b.theta;
    return true;
  }

  // Moves the clamps to pose i and the shape with them.
  bool reach(std::size_t i) {
    const Relative b = relative(strip_.poses[i], theta_);
    if (!(b.off_plane_mm <= kShapeMismatchMm))
      return stop(BranchStatus::kOutOfPlane, i, b.off_plane_mm, kShapeMismatchMm);
    theta_ = b.theta;
    const elastica::ClampPair to{{0, 0, 0}, {b.x, b.y, b.theta}};
    const double chord = std::hypot(b.x, b.y), length = strip_.blade_length_mm;
    if (chord >= kTaut * length) return reach_taut(i, chord);
    if (was_taut_) return leave_taut(i, to);
    const elastica::FollowReport way = elastica::follow(shape_, to);
    shape_ = way.shape.elastica;
    if (way.status == elastica::FollowStatus::kFollowed) return true;
    if (way.status == elastica::FollowStatus::kOutOfReach)
      return stop(BranchStatus::kOutOfReach, i, chord, length);
    return stop(BranchStatus::kSnapped, i, elastica::stability_margin(shape_), options_.min_margin);
  }

  bool reach_taut(std::size_t i, double chord) {
    if (!(chord <= strip_.blade_length_mm * (1 + 1e-6)))
      return stop(BranchStatus::kOutOfReach, i, chord, strip_.blade_length_mm);
    shape_ = seen_from_a(strip_.poses[i].blade);
    was_taut_ = true;
    ++report_.taut_poses;
    return true;
  }

  // From a straight blade the clamps' turn picks the side; the shape is solved for from the program's own.
  bool leave_taut(std::size_t i, const elastica::ClampPair& to) {
    const auto solved = elastica::solve_clamped(seen_from_a(strip_.poses[i].blade), to);
    if (!solved || !solved->stable()) return stop(BranchStatus::kSnapped, i, 0, options_.min_margin);
    shape_ = solved->elastica;
    was_taut_ = false;
    return true;
  }

  bool compare(std::size_t i) {
    const double off = distance_mm(shape_, seen_from_a(strip_.poses[i].blade));
    if (!(off <= report_.mismatch_mm)) report_.mismatch_mm = off;
    return off <= kShapeMismatchMm || stop(BranchStatus::kElsewhere, i, off, kShapeMismatchMm);
  }

  bool check_limits(std::size_t i) {
    // Shapes change slowly from waypoint to waypoint; the first and the last count too.
    constexpr std::size_t kEvery = 16;
    if (i % kEvery != 0 && i + 1 != strip_.poses.size()) return true;
    const double bent = elastica::ElasticaCurve(shape_).max_abs_curvature();
    report_.largest_curvature_per_mm = std::max(report_.largest_curvature_per_mm, bent);
    if (!(bent <= options_.max_curvature_per_mm * (1 + 1e-9)))
      return stop(BranchStatus::kYields, i, 1 / bent, 1 / options_.max_curvature_per_mm);
    const double margin = elastica::stability_margin(shape_);
    report_.smallest_margin = std::min(report_.smallest_margin, margin);
    return margin >= options_.min_margin || stop(BranchStatus::kUnsafe, i, margin, options_.min_margin);
  }

  const Strip& strip_;
  const BranchOptions& options_;
  BranchReport report_;
  Elastica shape_;
  double theta_ = 0;
  bool was_taut_ = false;
};

// The limit of a finding, its unit and what to do.
struct BranchLimit {
  const char *name, *unit, *hint;
};

BranchLimit limit_of(BranchStatus status) {
  switch (status) {
    case BranchStatus::kNoFlatArc:
      return {"half turn of the flat arc at the start", "rad",
              "a strip starts at a flat arc of 0.10 to 0.17 rad"};
    case BranchStatus::kOutOfPlane:
      return {"distance of clamp B from clamp A's plane", "mm", "both clamps of a waypoint lie in one plane"};
    case BranchStatus::kSnapped:
      return {"stability margin, the blade snaps through", "", "a shorter blade or more splits"};
    case BranchStatus::kOutOfReach:
      return {"distance between the clamps", "mm", "the blade is pulled taut: a longer blade"};
    case BranchStatus::kElsewhere:
      return {"distance of the blade from the planned shape", "mm",
              "the clamps lead the blade to another shape than the plan's"};
    case BranchStatus::kYields:
      return {"blade radius", "mm", "the blade would yield: a thinner blade or more splits"};
    case BranchStatus::kUnsafe:
      return {"stability margin", "", "the blade could snap through: a shorter blade or more splits"};
    case BranchStatus::kHeld:
      break;
  }
  return {"held", "", ""};
}

}  // namespace

Refusal branch_refusal(const Strip& strip, const BranchReport& report) {
  const BranchLimit limit = limit_of(report.status);
  Refusal refusal{strip.id, "", limit.name, report.value, report.bound, limit.unit, limit.hint};
  if (report.pose >= strip.poses.size()) return refusal;
  const BladePose& pose = strip.poses[report.pose];
  refusal.rib = rib_at(strip, report.pose);
  refusal.limit += fmt::format(", in phase {} at {:.2f} s", pose.phase, pose.t);
  return refusal;
}

BranchReport follow_branch(const Strip& strip, const BranchOptions& options) {
  if (strip.poses.empty()) return {BranchStatus::kNoFlatArc, 0, 0, 0, 0, 0, 0, 0};
  return Follower(strip, options).run();
}

std::string rib_at(const Strip& strip, std::size_t pose) {
  if (!strip.poses[pose].foam) return "";
  for (std::size_t away = 0; away < strip.poses.size(); ++away) {
    for (const std::size_t i : {pose - std::min(away, pose), std::min(pose + away, strip.poses.size() - 1)}) {
      if (strip.poses[i].rib) return strip.ribs[static_cast<std::size_t>(*strip.poses[i].rib)].id;
    }
  }
  return "";
}

}  // namespace hotblade::pipeline
