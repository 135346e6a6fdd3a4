#include "pipeline/verify/branch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "elastica/blade/blade_batch.hpp"
#include "elastica/curve/placement.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/sayings/saying.hpp"
#include "robot/blade/blade_branch.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::Elastica;

// What the following of one pose found, before its shape is compared with the plan's.
struct FollowedPose {
  Elastica shape;
  double margin = 0;
  bool taut = false;
};

// Winds more than any blade, or is not a number: nowhere near a shape that was followed.
bool wild(const Elastica& e) {
  constexpr double kMostRate = 1000;
  return !(elastica::taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2) * e.length <= kMostRate);
}

// Margins are computed at every so many poses, many at once: what could bring the blade to its limit in
// between is looked at while it is followed (robot/blade/blade_branch.hpp).
constexpr std::size_t kMarginEvery = 16;

// Of some poses: how far the blade is from where the program says, its largest curvature, and the margins of
// every so many of them.
struct FollowedBlock {
  std::vector<double> off_mm, curvature_per_mm, margin;

  FollowedBlock(std::span<const FollowedPose> followed, std::span<const BladePose> poses) {
    constexpr std::size_t kPoints = 9, kMost = 65;
    std::vector<Elastica> found, planned, some;
    std::vector<elastica::Part> whole;
    for (std::size_t i = 0; i < followed.size(); ++i) {
      found.push_back(followed[i].shape);
      if (i % kMarginEvery == 0) some.push_back(followed[i].shape);
      planned.push_back(wild(poses[i].blade) ? Elastica{} : elastica::at_origin(poses[i].blade));
      whole.push_back({0, followed[i].shape.length});
    }
    // Every so many points of the one are beside a point of the other.
    const std::size_t fine = elastica::curvature_points(found, kMost), every = (fine - 1) / (kPoints - 1);
    const elastica::PartPoints is = elastica::sample_parts(found, whole, fine);
    for (std::size_t i = 0; i < followed.size(); ++i) whole[i].last = planned[i].length;
    const elastica::PartPlaces should = elastica::sample_places(planned, whole, kPoints);
    for (std::size_t i = 0; i < followed.size(); ++i) {
      double largest = wild(poses[i].blade) ? std::numeric_limits<double>::infinity() : 0;
      for (std::size_t k = 0; k < kPoints; ++k)
        largest = std::max(largest, (is.at(i, every * k) - should.at(i, k)).norm());
      off_mm.push_back(largest);
      curvature_per_mm.push_back(elastica::max_abs_curvature(found[i], is, i));
    }
    margin.resize(some.size());
    elastica::stability_margins(some, margin);
  }
};

// Adds what was found of the poses to the report, up to where the blade is elsewhere or too near to a snap.
void compare(const Strip& strip, std::span<const FollowedPose> followed, double min_margin,
             BranchReport& report) {
  constexpr std::size_t kBlock = 256;
  static_assert(kBlock % kMarginEvery == 0);
  const auto find = [&](Limit limit, std::size_t pose, double value, double bound) {
    report.limit = limit;
    report.pose = pose;
    report.value = value;
    report.bound = bound;
  };
  for (std::size_t from = 0; from < followed.size(); from += kBlock) {
    const std::size_t count = std::min(kBlock, followed.size() - from);
    const FollowedBlock block(followed.subspan(from, count), std::span(strip.poses).subspan(from, count));
    for (std::size_t i = 0; i < count; ++i) {
      const FollowedPose& pose = followed[from + i];
      report.largest_curvature_per_mm = std::max(report.largest_curvature_per_mm, block.curvature_per_mm[i]);
      report.smallest_margin = std::min(report.smallest_margin, pose.margin);
      // The pose of a finding is the last one, and is not compared.
      if (!report.held() && from + i == report.pose) return;
      if (i % kMarginEvery == 0) {
        const double margin = block.margin[i / kMarginEvery];
        report.smallest_margin = std::min(report.smallest_margin, margin);
        if (!(margin >= min_margin)) return find(Limit::kBladeMargin, from + i, margin, min_margin);
      }
      if (pose.taut) {
        ++report.taut_poses;
        continue;
      }
      const double off = block.off_mm[i];
      if (!(off <= report.mismatch_mm)) report.mismatch_mm = off;
      if (off <= kShapeMismatchMm) continue;  // not a number goes on to be found
      return find(Limit::kPlannedShape, from + i, off, kShapeMismatchMm);
    }
  }
}

}  // namespace

Refusal branch_refusal(const Strip& strip, const BranchReport& report) {
  Refusal refusal{strip.id, "", report.limit, report.value, report.bound};
  if (report.pose >= strip.poses.size()) return refusal;
  const BladePose& pose = strip.poses[report.pose];
  refusal.rib = rib_at(strip, report.pose);
  refusal.when = say(Saying::kInPhase, {name(pose.phase), pose.t});
  refusal.at = middle_of(pose);
  return refusal;
}

BranchReport follow_branch(const Strip& strip, const BranchOptions& options) {
  BranchReport report;
  if (strip.poses.empty()) report.limit = Limit::kStartPose;
  report.smallest_margin = std::numeric_limits<double>::infinity();
  robot::BladeBranch blade(strip.blade_length_mm, {options.max_curvature_per_mm, options.min_margin,
                                                   kShapeMismatchMm, 0, std::numeric_limits<int>::max()});
  std::vector<FollowedPose> followed;
  for (std::size_t i = 0; i < strip.poses.size() && report.held(); ++i) {
    gpu::stop_point();
    const robot::BladeFinding finding = blade.move_to(robot::held(strip.poses[i].a, options.offsets.a),
                                                      robot::held(strip.poses[i].b, options.offsets.b));
    followed.push_back({blade.shape(), blade.margin(), blade.taut()});
    if (finding.held()) continue;
    report.limit = finding.limit;
    report.pose = i;
    report.value = finding.value;
    report.bound = finding.bound;
  }
  compare(strip, followed, options.min_margin, report);
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
