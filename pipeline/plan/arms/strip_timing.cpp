#include "pipeline/plan/arms/strip_timing.hpp"

#include <algorithm>

#include "pipeline/plan/motion/slow_feed.hpp"
#include "pipeline/sayings/saying.hpp"
#include "robot/pose/motion.hpp"

namespace hotblade::pipeline {
namespace {

// The slowest cut that a joint asks for, where that is below what foam bears.
std::optional<Refusal> refusal_of(const Strip& strip, const std::vector<LimitedWay>& moving,
                                  const MotionSettings& motion, const std::vector<double>& before,
                                  const std::vector<double>& now) {
  const std::vector<StepFeed> feeds = step_feeds(strip.poses, true);
  double least = motion.min_feed_mm_s;
  std::size_t worst = 0;
  for (std::size_t k = 1; k < feeds.size(); ++k) {
    const double by = (now[k] - now[k - 1]) / (before[k] - before[k - 1]);
    const bool cuts = feeds[k].fastest_mm_s > 0, slowed = by > 1 + 1e-6;
    if (!cuts || !slowed || feeds[k].slowest_mm_s / by >= least) continue;
    least = feeds[k].slowest_mm_s / by;
    worst = k;
  }
  if (worst == 0) return std::nullopt;
  const LimitedWay& tight = moving[tightest(before, moving, worst)];
  const BladePose& at = strip.poses[worst];
  Refusal refusal{strip.id,
                  "",
                  Limit::kSlowestFeed,
                  least,
                  motion.min_feed_mm_s,
                  say(Saying::kJointTooSlow, {tight.name, least, motion.min_feed_mm_s})};
  refusal.when = say(Saying::kInPhase, {name(at.phase), at.t});
  refusal.at = middle_of(at);
  return refusal;
}

}  // namespace

std::vector<LimitedWay> moving_joints(const robot::Cell& cell, const HeldJoints& held) {
  std::vector<LimitedWay> all;
  for (std::size_t clamp = 0; clamp < held.arm.size(); ++clamp) {
    const robot::CellArm& arm = cell.arms[held.arm[clamp]];
    const std::vector<robot::JointAngles>& angles = held.joints[clamp];
    for (std::size_t i = 0; i < robot::kJoints; ++i) {
      const robot::Joint& joint = arm.model.arm.joints()[i];
      LimitedWay way{{},
                     arm.speed_share * joint.speed_rad_s,
                     arm.acceleration_rad_s2[i],
                     arm.jerk_rad_s3[i],
                     robot::PathClock::kRampPerS,
                     say(Saying::kArmPart, {arm.id, joint.name})};
      const auto j = static_cast<int>(i);
      for (std::size_t k = 1; k < angles.size(); ++k)
        way.step.emplace_back(angles[k][j] - angles[k - 1][j], 0, 0);
      all.push_back(std::move(way));
    }
  }
  return all;
}

StripTiming time_for_arms(const Strip& strip, const MotionSettings& motion, const robot::Cell& cell,
                          const HeldJoints& held) {
  std::vector<LimitedWay> moving = moving_clamps(strip.poses, motion);
  for (LimitedWay& joint : moving_joints(cell, held)) moving.push_back(std::move(joint));
  std::vector<double> t;
  for (const BladePose& pose : strip.poses) t.push_back(pose.t);
  StripTiming timing{slower(t, moving), {}};
  timing.refusal = refusal_of(strip, moving, motion, t, timing.slower.t);
  return timing;
}

}  // namespace hotblade::pipeline
