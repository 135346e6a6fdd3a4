// Waypoints that stay where they are and are met later: what clamps and joints may do holds, and no step is
// shorter than it was.
//
// Between two rests the way of everything that moves is one path through the waypoints. The fastest law along
// it that is nowhere faster than before, and keeps speeds and accelerations (rate_bounds.hpp), is averaged
// over a window of time (smooth_law.hpp), which takes the jumps out of its accelerations. Then the waypoints
// are measured as a controller measures them, and where a limit is exceeded the law is lowered there, and
// only there, until all hold.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Something that moves, by its way from each waypoint to the next, with limits of its own: a clamp's place,
// its turn, or a joint.
struct LimitedWay {
  std::vector<Eigen::Vector3d> step;
  double speed = std::numeric_limits<double>::infinity();
  double accel = std::numeric_limits<double>::infinity();
  double jerk = std::numeric_limits<double>::infinity();
  // What the ramp of a hold adds to its acceleration for each unit of speed, 1/s.
  double ramp_per_s = 0;
  std::string name{};  // for people
};

// Returns the ways of both clamps' places and turns, with limits of jerk where the settings have them.
[[nodiscard]] std::vector<LimitedWay> moving_clamps(std::span<const BladePose> poses,
                                                    const MotionSettings& limits);

// What waypoints use of the limits, shares: over a step its speed, at a waypoint the acceleration with the
// ramp of a hold, at the waypoint behind a step the jerk over it and its neighbours. At rest before the first
// and after the last waypoint.
struct Use {
  double speed = 0, accel = 0, jerk = 0;
  [[nodiscard]] double most() const { return std::max({speed, accel, jerk}); }
};
[[nodiscard]] std::vector<Use> uses(std::span<const double> t, const LimitedWay& moving);

struct Slower {
  std::vector<double> t;            // whole microseconds
  double joints_s = 0, jerk_s = 0;  // what speeds and accelerations take, and what jerk takes besides
};

// Returns times that keep all limits: those given, where they do. A step over which nothing moves is as long
// as before. Needs at least two waypoints, at ascending times in whole microseconds.
[[nodiscard]] Slower slower(std::vector<double> t, std::span<const LimitedWay> moving);

// Returns the index of what uses most of its limits within a window around a step, which ends at a waypoint.
[[nodiscard]] std::size_t tightest(std::span<const double> t, std::span<const LimitedWay> moving,
                                   std::size_t waypoint);

}  // namespace hotblade::pipeline
