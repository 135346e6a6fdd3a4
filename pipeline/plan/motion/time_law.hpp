// Time along a path: as fast as the limits allow, at rest at both ends.
//
// The path is given by dense samples; every limit becomes a cap on the path's rate and acceleration, and one
// forward and one backward pass give the fastest profile of piecewise constant path acceleration. Jerk is not
// limited.
#pragma once

#include <functional>
#include <vector>

#include "pipeline/settings/settings.hpp"
#include "robot/pose/pose.hpp"

namespace hotblade::pipeline {

// What a path sample is limited by.
struct PathSample {
  robot::Pose a, b;                      // clamps, mm
  std::vector<Eigen::Vector3d> in_foam;  // blade points whose speed the feed limits; empty in air
};

// Path parameters in [0, 1] at even times, first 0, last 1; `step_s` is at most motion.waypoint_s.
struct TimeLaw {
  double duration_s = 0, step_s = 0;
  std::vector<double> sigma;
};

// Returns the fastest law for samples at even path parameters, at least 3. A path that does not move gives
// duration 0 and sigma {0, 1}.
[[nodiscard]] TimeLaw fastest_time_law(const std::vector<PathSample>& samples, const MotionSettings& limits);

}  // namespace hotblade::pipeline
