// What the machine may do, and the check of a waypoint stream against it.
//
// Between waypoints positions are linear and orientations a slerp, in time. Speeds are therefore constant on
// a step, a box envelope holds on a step when it holds at both ends, and the chord |b - a| is a convex
// function of time: checking the waypoints checks the interpolated path too. Accelerations are second
// differences.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "robot/pose/clamp_offset.hpp"
#include "robot/pose/limit.hpp"
#include "robot/pose/rates.hpp"
#include "robot/pose/waypoint.hpp"

namespace hotblade::robot {

// What each clamp may do, in the cell frame. The defaults are those of a mid-size two-arm cell.
struct MotionLimits {
  double speed_mm_s = 100, accel_mm_s2 = 500;
  double angular_rad_s = 1, angular_accel_rad_s2 = 2;
  Eigen::Vector3d envelope_min_mm{-2000, -2000, 0}, envelope_max_mm{2000, 2000, 3000};
  std::uint32_t min_dt_us = 5000;
  // The chord stays within blade length * (1 - slack), give or take the registers' rounding. None is asked
  // for by default: ruled surfaces are cut with a straight blade, whose chord is its length.
  double chord_slack = 0;
  // The clamps hold the blade so far from where they are told to be: chord and start pose are those of the
  // blade.
  ClampOffsets clamps{};
};

// Follows a stream of waypoints, across window borders. It is copyable: check a window on a copy, and keep
// the copy when the whole window holds. It never allocates or throws.
class LimitChecker {
 public:
  LimitChecker() = default;
  LimitChecker(const MotionLimits& limits, double blade_length_mm)
      : limits_(limits), blade_length_mm_(blade_length_mm) {}

  // Returns the first limit that the next waypoint breaks; the waypoint becomes part of the stream when there
  // is none. The strip starts at rest. Quantisation is allowed for: a register is off by up to 0.5 um and 0.5
  // us, so a speed by sqrt(3) um / dt + 1 us / dt of itself and an acceleration by those of both steps over
  // the mean step.
  [[nodiscard]] Limit next(const Waypoint& waypoint);

  // Returns the limit that the stop at the end of the stream breaks, from the last step's speed to rest
  // within that step.
  [[nodiscard]] Limit finish() const;

 private:
  [[nodiscard]] Limit check_first(const Waypoint& waypoint) const;
  [[nodiscard]] Limit check_place(const Waypoint& waypoint) const;
  [[nodiscard]] Limit check_speed(const ClampRates& v, double dt) const;
  [[nodiscard]] Limit check_change(const ClampRates& from, const ClampRates& to, double dt0,
                                   double dt1) const;

  MotionLimits limits_;
  double blade_length_mm_ = 0;
  bool started_ = false;
  Waypoint last_;
  ClampRates va_, vb_;
  double last_dt_ = 0;  // s; 0 before the first step
};

}  // namespace hotblade::robot
