// Where foam would melt too wide: the slowest point of the blade while it cuts.
#pragma once

#include <string>

#include "pipeline/plan/motion/motion.hpp"

namespace hotblade::pipeline {

// The slowest blade point in foam of a cut.
struct SlowFeed {
  double slowest_mm_s = 0;
  double fastest_mm_s = 0;  // of the blade's points at the same place
  std::size_t pose = 0;     // at the end of the step
};

// Of the blade's points in foam on the step that ends at a pose; 0 where it does not cut.
struct StepFeed {
  double slowest_mm_s = 0, fastest_mm_s = 0;
};
[[nodiscard]] std::vector<StepFeed> step_feeds(const std::vector<BladePose>& poses, bool same_points);

// Returns it over the poses that cut; a slowest feed of 0 where none does. What of the blade forms the design
// may change from pose to pose: with `same_points` the same points are looked at in both.
[[nodiscard]] SlowFeed slowest_feed(const std::vector<BladePose>& poses, bool same_points);

// Returns why a blade is too slow there: it turns about a place near it, or a limit of the clamps holds it
// back, by name and what it would have to be. `jerk_share`: of the step's time, what limits of jerk leave for
// all else; 1 where they take nothing.
[[nodiscard]] std::string why_slow(const SlowFeed& slow, const std::vector<BladePose>& poses,
                                   bool planes_turn, const MotionSettings& motion, double jerk_share);

}  // namespace hotblade::pipeline
