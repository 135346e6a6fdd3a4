#include "pipeline/verify/branch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "elastica/blade/blade_batch.hpp"
#include "elastica/curve/placement.hpp"
#include "gpu/backend/stop.hpp"
#include "pipeline/sayings/saying.hpp"
#include "robot/blade/blade_branch.hpp"
#include "robot/blade/common_plane.hpp"
#include "robot/pose/motion.hpp"
#include "robot/wire/protocol.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::Elastica;
using robot::ClampPoses;

// What the following of one pose found, before its shape is compared with the plan's.
struct FollowedPose {
  Elastica shape;
  double margin = 0;
  bool taut = false;
  std::optional<Elastica> told;  // by the registers alone, where the shape is by the clamps as computed
};

// Winds more than any blade, or is not a number: nowhere near a shape that was followed.
bool wild(const Elastica& e) {
  constexpr double kMostRate = 1000;
  return !(elastica::taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2) * e.length <= kMostRate);
}

// How far a blade is off across itself, mm: the most at the points of what is in foam, and in each of its
// parts.
struct Off {
  double most_mm = 0;
  std::array<float, kBladeParts> parts_mm{};
};

// Of the blade against the planned one; a part is off by the more of both its ends. By points `every` so many
// of which stand beside one of the planned.
Off across_in_foam_mm(const elastica::PartPoints& is, const elastica::PartPlaces& should, std::size_t i,
                      std::size_t every, const BladePose& pose,
                      const std::optional<std::array<double, 2>>& foam) {
  Off off{};
  if (!foam || wild(pose.blade)) return off;
  const double apart = pose.blade.length / static_cast<double>(should.points - 1);
  for (std::size_t k = 0; k < should.points; ++k) {
    const double s = apart * static_cast<double>(k);
    if (s < (*foam)[0] - apart || s > (*foam)[1] + apart) continue;
    const std::size_t at = i * is.points + every * k;
    const Eigen::Vector2d away = is.at(i, every * k) - should.at(i, k);
    const double across = std::abs(is.cos[at] * away.y() - is.sin[at] * away.x());
    if (s >= (*foam)[0] - 0.5 * apart && s <= (*foam)[1] + 0.5 * apart)
      off.most_mm = std::max(off.most_mm, across);
    for (const std::size_t part : {k - 1, k}) {
      if (part < kBladeParts) off.parts_mm[part] = std::max(off.parts_mm[part], static_cast<float>(across));
    }
  }
  return off;
}

// Margins are computed at every so many poses, many at once: what could bring the blade to its limit in
// between is looked at while it is followed (robot/blade/blade_branch.hpp).
constexpr std::size_t kMarginEvery = 16;

// What of the blade forms the design: a pose's own part, or that of the first or last pose in foam, whose
// border the width of a hot one before or behind it passes over.
class FormedParts {
 public:
  explicit FormedParts(const Strip& strip) {
    const auto in_foam = [](const BladePose& pose) { return pose.foam.has_value(); };
    const auto first = std::find_if(strip.poses.begin(), strip.poses.end(), in_foam);
    if (first == strip.poses.end()) return;
    const auto last = std::find_if(strip.poses.rbegin(), strip.poses.rend(), in_foam);
    first_ = {first->t, first->foam};
    last_ = {last->t, last->foam};
  }

  [[nodiscard]] std::optional<std::array<double, 2>> of(const BladePose& pose) const {
    if (pose.foam || !pose.heat) return pose.foam;
    if (pose.t < first_.t) return first_.part;
    return pose.t > last_.t ? last_.part : std::nullopt;
  }

 private:
  struct At {
    double t = 0;
    std::optional<std::array<double, 2>> part;
  };
  At first_, last_;
};

// Of some poses: how far the blade is from where the program says, and what forms the design across itself by
// registers alone; its largest curvature, and the margins of every so many of them.
struct FollowedBlock {
  std::vector<double> off_mm, curvature_per_mm, margin;
  std::vector<Off> told_off_mm;

  FollowedBlock(std::span<const FollowedPose> followed, std::span<const BladePose> poses,
                const FormedParts& formed) {
    constexpr std::size_t kPoints = kBladeParts + 1, kMost = 65;
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
    const bool same = std::none_of(followed.begin(), followed.end(), [](const auto& f) { return f.told; });
    if (!same) {
      for (std::size_t i = 0; i < followed.size(); ++i) {
        if (followed[i].told) found[i] = *followed[i].told;
      }
    }
    const elastica::PartPoints told =
        same ? elastica::PartPoints{} : elastica::sample_parts(found, whole, fine);
    for (std::size_t i = 0; i < followed.size(); ++i)
      told_off_mm.push_back(
          across_in_foam_mm(same ? is : told, should, i, every, poses[i], formed.of(poses[i])));
    margin.resize(some.size());
    elastica::stability_margins(some, margin);
  }
};

// Of two shapes, a hundredth of a millimetre in a tenth of a metre.
constexpr double kSameBend = 1e-3;

robot::BladeLimits limits_of(const BranchOptions& options, double rounding_mm) {
  return {options.max_curvature_per_mm, options.min_margin, robot::kMaxOffPlane_mm, rounding_mm,
          std::numeric_limits<int>::max()};
}

// Moves the blade to a waypoint over the pose halfway to it, as robot::BladeCheck::next() does. That one is
// left out where it can be no limit: waypoints are so close that the blade comes to the same shape.
robot::BladeFinding move_on(robot::BladeBranch& blade, const ClampPoses& halfway, const ClampPoses& to) {
  const double off_mm = robot::seen_from_a(halfway, 0).off_plane_mm;
  if (!(off_mm <= robot::kMaxOffPlane_mm)) return {Limit::kBladePlane, off_mm, robot::kMaxOffPlane_mm};
  if (!blade.far_from_limits(halfway.a, halfway.b)) {
    const robot::BladeFinding between = blade.move_to(halfway.a, halfway.b);
    if (!between.held()) return between;
  }
  return blade.move_to(to.a, to.b);
}

// How far the blade is from where the program says, were its clamps where they were computed, near to a shape
// that micrometres gave it. It is infinite where no shape is found.
double off_as_computed_mm(const Elastica& as_told, const BladePose& pose,
                          const robot::ClampOffsets& offsets) {
  constexpr int kPoints = 9;
  const ClampPoses computed = robot::held({pose.a, pose.b}, offsets);
  const elastica::PlanarPose b = robot::seen_from_a(computed, elastica::clamps_of(as_told).b.theta).b;
  const elastica::FollowReport way = elastica::follow(as_told, {{0, 0, 0}, b});
  if (way.status != elastica::FollowStatus::kFollowed || wild(pose.blade))
    return std::numeric_limits<double>::infinity();
  const auto is = elastica::sample(way.shape.elastica, kPoints),
             should = elastica::sample(elastica::at_origin(pose.blade), kPoints);
  double largest = 0;
  for (std::size_t k = 0; k < is.size(); ++k)
    largest = std::max(largest, std::hypot(is[k].x - should[k].x, is[k].y - should[k].y));
  return largest;
}

// Adds what was found of the poses to the report, up to where the blade is elsewhere or too near to a snap.
void compare(const Strip& strip, std::span<const FollowedPose> followed, const BranchOptions& options,
             BranchReport& report) {
  constexpr std::size_t kBlock = 256;
  static_assert(kBlock % kMarginEvery == 0);
  const auto find = [&](Limit limit, std::size_t pose, double value, double bound) {
    report.limit = limit;
    report.pose = pose;
    report.value = value;
    report.bound = bound;
  };
  const FormedParts formed(strip);
  for (std::size_t from = 0; from < followed.size(); from += kBlock) {
    const std::size_t count = std::min(kBlock, followed.size() - from);
    const FollowedBlock block(followed.subspan(from, count), std::span(strip.poses).subspan(from, count),
                              formed);
    for (std::size_t i = 0; i < count; ++i) {
      const FollowedPose& pose = followed[from + i];
      report.largest_curvature_per_mm = std::max(report.largest_curvature_per_mm, block.curvature_per_mm[i]);
      report.smallest_margin = std::min(report.smallest_margin, pose.margin);
      // The pose of a finding is the last one, and is not compared.
      if (!report.held() && from + i == report.pose) return;
      const Off& told_off = block.told_off_mm[i];
      report.told_off.add(told_off.parts_mm);
      if (strip.poses[from + i].foam) report.told_off_mm = std::max(report.told_off_mm, told_off.most_mm);
      if (i % kMarginEvery == 0) {
        const double margin = block.margin[i / kMarginEvery];
        report.smallest_margin = std::min(report.smallest_margin, margin);
        if (!(margin >= options.min_margin))
          return find(Limit::kBladeMargin, from + i, margin, options.min_margin);
      }
      if (pose.taut) {
        ++report.taut_poses;
        continue;
      }
      double off = block.off_mm[i];
      if (!(off <= report.mismatch_mm)) report.mismatch_mm = off;
      if (off <= kShapeMismatchMm) continue;  // not a number goes on to be found
      // A micrometre moves a nearly straight blade by far more than itself.
      off = std::min(off, off_as_computed_mm(pose.shape, strip.poses[from + i], options.offsets));
      if (off <= kShapeMismatchMm) continue;
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
  robot::BladeBranch blade(strip.blade_length_mm, limits_of(options, robot::kRegisterRounding_mm));
  // Where registers cannot tell the blade from a straight one, the clamps as computed may; and on which side
  // it leaves the line, until both are of one shape again.
  std::optional<robot::BladeBranch> nearly_straight;
  const std::vector<robot::Waypoint> told = waypoints(strip);
  std::vector<FollowedPose> followed;
  constexpr double kHalfway = 0.5;
  ClampPoses last;
  for (std::size_t i = 0; i < strip.poses.size() && report.held(); ++i) {
    gpu::stop_point();
    const ClampPoses in_cell{told[i].a, told[i].b};
    // Nobody is told of clamps that registers cannot hold: robot::make_job refuses them.
    const ClampPoses as_told = robot::protocol::as_read(in_cell).value_or(in_cell);
    const ClampPoses to = robot::held(as_told, options.offsets);
    const Elastica before = blade.shape();
    robot::BladeFinding finding =
        i == 0
            ? blade.move_to(to.a, to.b)
            : move_on(blade, robot::held(robot::interpolate(last, as_told, kHalfway), options.offsets), to);
    last = as_told;
    if (finding.held() && !(blade.off_plane_mm() <= kShapeMismatchMm))
      finding = {Limit::kBladePlane, blade.off_plane_mm(), kShapeMismatchMm};
    followed.push_back({blade.shape(), blade.margin(), false, {}});
    if (blade.taut() && !nearly_straight) nearly_straight.emplace(before, limits_of(options, 0));
    if (nearly_straight && finding.held()) {
      const ClampPoses computed = robot::held({strip.poses[i].a, strip.poses[i].b}, options.offsets);
      finding = nearly_straight->move_to(computed.a, computed.b);
      followed.back() = {nearly_straight->shape(), std::min(blade.margin(), nearly_straight->margin()),
                         nearly_straight->taut(), blade.shape()};
      if (!blade.taut() && robot::bend_between(blade.shape(), nearly_straight->shape()) <= kSameBend)
        nearly_straight.reset();
    }
    if (finding.held()) continue;
    report.limit = finding.limit;
    report.pose = i;
    report.value = finding.value;
    report.bound = finding.bound;
  }
  compare(strip, followed, options, report);
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

std::string nearest_rib(const Strip& strip, const Eigen::Vector3d& at) {
  std::string id;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Rib& rib : strip.ribs) {
    const double off = std::abs(rib.frame.normal().dot(at - rib.frame.origin));
    if (off < nearest) {
      nearest = off;
      id = rib.id;
    }
  }
  return id;
}

}  // namespace hotblade::pipeline
