// Motion along a path of waypoints: where the clamps are between two waypoints, and how the path is slowed
// down.
#pragma once

#include <limits>

#include "robot/pose/waypoint.hpp"

namespace hotblade::robot {

// Positions linear, orientations slerp by the shorter arc; share in [0, 1].
[[nodiscard]] Pose interpolate(const Pose& from, const Pose& to, double share);

// The path parameter (s, the strip's own time) against the motion clock: both clamps follow this one
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
  // Against the path parameter, on the way out of a kerf. Rates and distances are counted along the way.
  [[nodiscard]] bool backwards() const { return direction_ < 0; }

  // Only at rest.
  void face(bool backwards) { direction_ = backwards ? -1 : 1; }

  // From rest at a waypoint where the path itself is at rest: the full rate at once.
  void start_at_full_rate() { rate_ = target_ = 1; }
  // An instant clock, which has no ramps, takes the new rate at once.
  void speed_up();
  void slow_down();
  void stop_at_once() { rate_ = target_ = 0; }

  // Path that a stop from here uses up, s.
  [[nodiscard]] double braking_s() const { return instant_ ? 0 : rate_ * rate_ / (2 * kRampPerS); }
  [[nodiscard]] double full_braking_s() const { return instant_ ? 0 : 1 / (2 * kRampPerS); }
  // Motion time until the ramp under way ends; infinite without one.
  [[nodiscard]] double ramp_left_s() const;
  // Motion time until a stop has to begin that ends `distance_s` from here; 0 when that is now. Exact, on the
  // ramp to the full rate too.
  [[nodiscard]] double time_to_brake_for(double distance_s) const;
  // Motion time until the path has gone on by `distance_s` at the present ramp; infinite when it stops
  // before.
  [[nodiscard]] double time_to(double distance_s) const;
  void advance(double dt_s);
  // Takes away rounding after advancing to a known place.
  void snap(double path_s) { path_s_ = path_s; }

 private:
  [[nodiscard]] double slope() const;

  bool instant_;
  double path_s_ = 0, rate_ = 0, target_ = 0, direction_ = 1;
};

}  // namespace hotblade::robot
