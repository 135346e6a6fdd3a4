// A stretch of a strip's path at the waypoints of its time law.
//
// What a controller checks are differences between waypoints; the law holds derivatives between samples. So
// the waypoints are measured as the controller measures them, and where one exceeds a limit the law is slowed
// there, and only there, until all hold.
#pragma once

#include <span>
#include <vector>

#include "elastica/blade/blade_batch.hpp"
#include "pipeline/plan/motion/blade_path.hpp"
#include "pipeline/plan/motion/time_law.hpp"
#include "pipeline/program/clamps.hpp"

namespace hotblade::pipeline {

// Shapes of the blade in their planes, between their clamps.
struct ClampedShapes {
  std::vector<BladeShape> shapes;
  std::vector<Frame> frames;
  std::vector<ClampPoses> pairs;
};

struct TimedStretch {
  TimeLaw law;
  ClampedShapes at;
};

// Returns the fastest law whose waypoints keep to the limits of settings.motion and, where planes turn,
// between waypoints to a common plane of both clamps.
[[nodiscard]] TimedStretch timed(const Stretch& stretch, const StripPlan& strip, const Settings& settings);

// The shares of the limits that waypoints at an even step use; a limit holds up to 1.
struct WaypointUse {
  double rate2 = 0;                     // on the step before: of speeds, squared, and of the common plane
  std::array<double, kTracks> accel{};  // at the waypoint
};

// Returns the use of each waypoint, of a path at rest at both ends. Rest is taken to lie half a step outside,
// so that the joint of two paths uses no more than either.
[[nodiscard]] std::vector<WaypointUse> waypoint_uses(std::span<const ClampPoses> pairs, double step_s,
                                                     const MotionSettings& limits, bool planes_turn);

// Blade points between the foam's ends whose speed the feed limits.
inline constexpr std::size_t kFeedPoints = 17;

}  // namespace hotblade::pipeline
