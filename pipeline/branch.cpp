#include "pipeline/branch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robot/blade_branch.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::Elastica;

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

BranchStatus status_of(robot::BladeStatus status) {
  switch (status) {
    case robot::BladeStatus::kNoFlatArc:
      return BranchStatus::kNoFlatArc;
    case robot::BladeStatus::kOutOfPlane:
      return BranchStatus::kOutOfPlane;
    case robot::BladeStatus::kOutOfReach:
      return BranchStatus::kOutOfReach;
    case robot::BladeStatus::kSnapped:
      return BranchStatus::kSnapped;
    case robot::BladeStatus::kYields:
      return BranchStatus::kYields;
    case robot::BladeStatus::kUnsafe:
      return BranchStatus::kUnsafe;
    case robot::BladeStatus::kHeld:
      break;
  }
  return BranchStatus::kHeld;
}

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
  BranchReport report;
  if (strip.poses.empty()) report.status = BranchStatus::kNoFlatArc;
  report.smallest_margin = std::numeric_limits<double>::infinity();
  robot::BladeBranch blade(strip.blade_length_mm,
                           {options.max_curvature_per_mm, options.min_margin, kShapeMismatchMm, 0});
  for (std::size_t i = 0; i < strip.poses.size() && report.status == BranchStatus::kHeld; ++i) {
    const BladePose& pose = strip.poses[i];
    const auto found = [&](BranchStatus status, double value, double bound) {
      report.status = status;
      report.pose = i;
      report.value = value;
      report.bound = bound;
    };
    const robot::BladeFinding finding = blade.move_to(pose.a, pose.b);
    report.largest_curvature_per_mm =
        std::max(report.largest_curvature_per_mm, blade.largest_curvature_per_mm());
    report.smallest_margin = std::min(report.smallest_margin, blade.margin());
    if (!finding.held()) found(status_of(finding.status), finding.value, finding.bound);
    if (!finding.held()) break;
    if (blade.taut()) {
      ++report.taut_poses;
      continue;
    }
    const double off = distance_mm(blade.shape(), seen_from_a(pose.blade));
    if (!(off <= report.mismatch_mm)) report.mismatch_mm = off;
    if (!(off <= kShapeMismatchMm)) found(BranchStatus::kElsewhere, off, kShapeMismatchMm);
  }
  return report;
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
