// Motion along a path of waypoints: where the clamps are between two waypoints, and how the path is slowed
// down.
#pragma once

#include <limits>

#include "robot/pose/waypoint.hpp"

namespace hotblade::robot {

// Returns the pose at a share in [0, 1] of the way: positions are linear, orientations a slerp by the shorter
// arc.
[[nodiscard]] Pose interpolate(const Pose& from, const Pose& to, double share);
// The same of both clamps.
[[nodiscard]] ClampPoses interpolate(const ClampPoses& from, const ClampPoses& to, double share);

// Turns the motion clock into the path parameter (s, the strip's own time): both clamps follow this one
// parameter, so slowing down keeps them on the path. The rate is 1 in normal motion and ramps linearly to and
// from 0.
//
// With a ramp of 2 per second a stop from full rate takes 0.5 s and 0.25 s of path; at 100 mm/s it adds 200
// mm/s^2.
class PathClock {
 public:
  static constexpr double kRampPerS = 2;

  explicit PathClock(bool instant = false) : instant_(instant) {}

  [[nodiscard]] double path_s() const { return path_s_; }
  [[nodiscard]] double rate() const { return rate_; }
  [[nodiscard]] bool at_rest() const { return rate_ <= 0 && target_ <= 0; }
  [[nodiscard]] bool stopping() const { return target_ <= 0; }
  // Returns whether the clamps go against the path parameter, on the way out of a kerf. Rates and distances
  // are counted along the way.
  [[nodiscard]] bool backwards() const { return direction_ < 0; }

  // Turns the way round; only at rest.
  void face(bool backwards) { direction_ = backwards ? -1 : 1; }

  // Takes the full rate at once, from rest at a waypoint where the path itself is at rest.
  void start_at_full_rate() { rate_ = target_ = 1; }
  // Begin a ramp; an instant clock, which has no ramps, takes the new rate at once.
  void speed_up();
  void slow_down();
  void stop_at_once() { rate_ = target_ = 0; }

  // Return the path that a stop uses up from here and from the full rate, s.
  [[nodiscard]] double braking_s() const { return instant_ ? 0 : rate_ * rate_ / (2 * kRampPerS); }
  [[nodiscard]] double full_braking_s() const { return instant_ ? 0 : 1 / (2 * kRampPerS); }
  // Returns the motion time until the ramp under way ends; infinite without one.
  [[nodiscard]] double ramp_left_s() const;
  // Returns the motion time until a stop has to begin that ends `distance_s` from here; 0 when that is now.
  // It is exact on the ramp to the full rate too.
  [[nodiscard]] double time_to_brake_for(double distance_s) const;
  // Returns the motion time until the path has gone on by `distance_s` at the present ramp; infinite when it
  // stops before.
  [[nodiscard]] double time_to(double distance_s) const;
  // Moves the motion clock on.
  void advance(double dt_s);
  // Sets the path parameter to a known place, to take away rounding after advancing to it.
  void snap(double path_s) { path_s_ = path_s; }

 private:
  [[nodiscard]] double slope() const;

  bool instant_;
  double path_s_ = 0, rate_ = 0, target_ = 0, direction_ = 1;
};

}  // namespace hotblade::robot
