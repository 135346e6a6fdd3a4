#include "pipeline/plan/motion/slow_feed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "elastica/blade/blade_batch.hpp"
#include "pipeline/plan/motion/blocks.hpp"
#include "pipeline/plan/motion/slower.hpp"
#include "pipeline/plan/motion/timed_stretch.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/settings/settings_fields.hpp"
#include "robot/pose/rates.hpp"

namespace hotblade::pipeline {

namespace {

// One limit of the clamps: how much of it is used, and by which power of the feed that grows.
struct Held {
  double use = 0;
  int power = 1;
  const char* name = "";
  const char* key = "";
  const char* unit = "";
  double limit = 0;
};

// What the clamps use most of on both sides of a pose: the law slows the blade before it reaches what holds
// it.
Held most_used(const std::vector<BladePose>& poses, std::size_t pose, const MotionSettings& motion) {
  constexpr std::size_t kAbout = 3;
  const std::size_t from = pose > kAbout ? pose - kAbout : 0, to = std::min(pose + kAbout, poses.size() - 1);
  std::vector<Held> all{
      {0, 1, "speed", "motion.travel_mm_s", "mm/s", motion.travel_mm_s},
      {0, 1, "angular speed", "motion.angular_rad_s", "rad/s", motion.angular_rad_s},
      {0, 2, "acceleration", "motion.accel_mm_s2", "mm/s2", motion.accel_mm_s2},
      {0, 2, "angular acceleration", "motion.angular_accel_rad_s2", "rad/s2", motion.angular_accel_rad_s2}};
  for (const auto clamp : {&BladePose::a, &BladePose::b}) {
    for (std::size_t i = from + 1; i < to; ++i) {
      const double dt0 = poses[i].t - poses[i - 1].t, dt1 = poses[i + 1].t - poses[i].t;
      const robot::ClampRates before = robot::rates_between(poses[i - 1].*clamp, poses[i].*clamp, dt0),
                              then = robot::rates_between(poses[i].*clamp, poses[i + 1].*clamp, dt1);
      const robot::ClampAccelerations change = robot::accelerations_between(before, then, dt0, dt1);
      const std::array<double, 4> is{then.linear.norm(), then.angular.norm(), change.linear_mm_s2,
                                     change.angular_rad_s2};
      for (std::size_t k = 0; k < all.size(); ++k) all[k].use = std::max(all[k].use, is[k] / all[k].limit);
    }
  }
  return *std::max_element(all.begin(), all.end(),
                           [](const Held& p, const Held& q) { return p.use < q.use; });
}

// The limit of jerk that a strip uses most of.
Held most_used_jerk(const std::vector<BladePose>& poses, const MotionSettings& motion) {
  Held place{0, 3, "limit of jerk", "motion.jerk_mm_s3", "mm/s3", motion.jerk_mm_s3},
      turn{0, 3, "limit of angular jerk", "motion.angular_jerk_rad_s3", "rad/s3", motion.angular_jerk_rad_s3};
  std::vector<double> t;
  t.reserve(poses.size());
  for (const BladePose& pose : poses) t.push_back(pose.t);
  const std::vector<LimitedWay> clamps = moving_clamps(poses, motion);
  for (std::size_t i = 0; i < clamps.size(); ++i) {
    Held& held = i % 2 == 0 ? place : turn;  // a clamp's turn is behind its place
    for (const Use& use : uses(t, clamps[i])) held.use = std::max(held.use, use.jerk);
  }
  return place.use >= turn.use ? place : turn;
}

bool cuts(const std::vector<BladePose>& poses, std::size_t step) {
  return poses[step - 1].foam && poses[step].foam;
}

// The feeds of the steps that end at poses from .. to - 1.
void weigh_steps(const std::vector<BladePose>& poses, std::size_t from, std::size_t to, bool same_points,
                 std::vector<StepFeed>& feeds) {
  const std::size_t first = from - 1, count = to - first;
  std::vector<elastica::Elastica> blades;
  std::vector<elastica::Part> foam;
  for (std::size_t i = first; i < to; ++i) {
    blades.push_back(poses[i].blade);
    foam.push_back(poses[i].foam ? elastica::Part{(*poses[i].foam)[0], (*poses[i].foam)[1]}
                                 : elastica::Part{});
  }
  const elastica::PartPlaces points = elastica::sample_places(blades, foam, kFeedPoints);
  elastica::PartPlaces same;
  if (same_points) {
    same = elastica::sample_places(std::span(blades).first(count - 1), std::span(foam).last(count - 1),
                                   kFeedPoints);
  }
  const elastica::PartPlaces& before = same_points ? same : points;
  for (std::size_t i = from; i < to; ++i) {
    if (!cuts(poses, i)) continue;
    const Frame &now = poses[i].frame, &then = poses[i - 1].frame;
    const Eigen::Vector3d moved = now.origin - then.origin;
    double least = std::numeric_limits<double>::infinity(), most = 0;  // squared
    for (std::size_t k = 0; k < kFeedPoints; ++k) {
      const Eigen::Vector2d q = points.at(i - first, k), p = before.at(i - 1 - first, k);
      const double way_sq =
          (moved + q.x() * now.x + q.y() * now.y - p.x() * then.x - p.y() * then.y).squaredNorm();
      least = std::min(least, way_sq);
      most = std::max(most, way_sq);
    }
    const double step_s = poses[i].t - poses[i - 1].t;
    feeds[i] = {std::sqrt(least) / step_s, std::sqrt(most) / step_s};
  }
}

// A number of two digits to set a limit to, no less than the one needed.
double settable(double needed) {
  constexpr double kRounding = 1e-9;
  const double step = std::pow(10, std::floor(std::log10(needed)) - 1);
  const double up = std::ceil(needed / step * (1 - kRounding)) * step;
  return std::stod(fmt::format("{:.2g}", up));  // the decimal, without what its product is off
}

}  // namespace

std::vector<StepFeed> step_feeds(const std::vector<BladePose>& poses, bool same_points) {
  std::vector<StepFeed> feeds(poses.size());
  const std::size_t steps = poses.empty() ? 0 : poses.size() - 1;
  in_blocks(steps, [&](std::size_t from, std::size_t to) {
    weigh_steps(poses, from + 1, to + 1, same_points, feeds);
  });
  return feeds;
}

SlowFeed slowest_feed(const std::vector<BladePose>& poses, bool same_points) {
  const std::vector<StepFeed> feeds = step_feeds(poses, same_points);
  SlowFeed slow{std::numeric_limits<double>::infinity(), 0, 0};
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (!cuts(poses, i)) continue;
    if (feeds[i].slowest_mm_s < slow.slowest_mm_s) slow = {feeds[i].slowest_mm_s, feeds[i].fastest_mm_s, i};
  }
  return std::isfinite(slow.slowest_mm_s) ? slow : SlowFeed{};
}

double fastest_in_block_mm_s(const std::vector<BladePose>& poses, const std::vector<elastica::Part>& in_block,
                             std::size_t pose) {
  if (pose == 0) return 0;
  std::vector<BladePose> step{poses[pose - 1], poses[pose]};
  for (std::size_t i = 0; i < 2; ++i) {
    const elastica::Part& part = in_block[pose - 1 + i];
    step[i].foam.reset();
    if (part.last > part.first) step[i].foam = {{part.first, part.last}};
  }
  return step_feeds(step, false)[1].fastest_mm_s;
}

std::string why_slow(const SlowFeed& slow, const std::vector<BladePose>& poses, bool planes_turn,
                     const MotionSettings& motion, double jerk_share, double in_block_mm_s) {
  // The fastest point has the feed there, or one in the waste beside the design, or else the clamps hold the
  // blade back.
  constexpr double kAtFeed = 0.9;
  const bool by_jerk = slow.slowest_mm_s >= jerk_share * motion.min_feed_mm_s;
  if ((!by_jerk && slow.fastest_mm_s >= kAtFeed * motion.feed_mm_s) || !(slow.slowest_mm_s > 0)) {
    return say(planes_turn ? Saying::kTurnsWithPlanes : Saying::kTurnsThere, {slow.fastest_mm_s});
  }
  // A tenth more, as the law leaves a little of each limit.
  constexpr double kMore = 1.1;
  const double slower = motion.min_feed_mm_s / slow.slowest_mm_s;
  if (!by_jerk && in_block_mm_s >= kAtFeed * motion.feed_mm_s)
    return say(Saying::kFasterInWaste,
               {in_block_mm_s, number_text(settable(kMore * motion.feed_mm_s * slower))});
  const Held held = by_jerk ? most_used_jerk(poses, motion) : most_used(poses, slow.pose, motion);
  const double needed = kMore * held.limit * std::pow(slower, static_cast<double>(held.power));
  return say(Saying::kHeldBack, {held.name, held.key, number_text(settable(needed)), held.unit});
}

}  // namespace hotblade::pipeline
