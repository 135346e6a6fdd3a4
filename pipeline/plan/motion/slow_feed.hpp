// Where foam would melt too wide: the slowest point of the blade while it cuts.
#pragma once

#include <string>

#include "elastica/blade/blade_batch.hpp"
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

// Returns the fastest point, mm/s, of what of the blade lies in its block, waste included, over the step that
// ends at a pose, as the feed limits it: `in_block` has the arc lengths of it for each pose, an empty part in
// air. 0 in air and at the first pose.
[[nodiscard]] double fastest_in_block_mm_s(const std::vector<BladePose>& poses,
                                           const std::vector<elastica::Part>& in_block, std::size_t pose);

// Returns why a blade is too slow there: it turns about a place near it, a point in the waste beside the
// design goes at the feed, or a limit of the clamps holds it back; by name, and what it would have to be.
// `jerk_share`: of the step's time, what limits of jerk leave for all else; 1 where they take nothing.
// `in_block_mm_s`: of the fastest point of the blade in its block there.
[[nodiscard]] std::string why_slow(const SlowFeed& slow, const std::vector<BladePose>& poses,
                                   bool planes_turn, const MotionSettings& motion, double jerk_share,
                                   double in_block_mm_s);

}  // namespace hotblade::pipeline
