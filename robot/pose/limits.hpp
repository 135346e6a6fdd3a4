// What the machine may do, and the check of a waypoint stream against it.
//
// Between waypoints positions are linear and orientations a slerp, in time. Speeds are therefore constant on
// a step, a box envelope holds on a step when it holds at both ends, and the chord |b - a| is a convex
// function of time: checking the waypoints checks the interpolated path too. Accelerations are second
// differences.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "robot/pose/waypoint.hpp"

namespace hotblade::robot {

// Per clamp, cell frame. The defaults are those of a mid-size two-arm cell.
struct MotionLimits {
  double speed_mm_s = 100, accel_mm_s2 = 500;
  double angular_rad_s = 1, angular_accel_rad_s2 = 2;
  Eigen::Vector3d envelope_min_mm{-2000, -2000, 0}, envelope_max_mm{2000, 2000, 3000};
  std::uint32_t min_dt_us = 5000;
  // The chord stays within blade length * (1 - slack), give or take the registers' rounding. None is asked
  // for by default: ruled surfaces are cut with a straight blade, whose chord is its length.
  double chord_slack = 0;
};

// Which limit a waypoint broke; the number stands in STATUS as the fault detail.
enum class LimitCode : std::uint16_t {
  kNone = 0,
  kCount = 1,  // beyond the announced number of waypoints, or the last flag is misplaced
  kQuaternion = 2,
  kHeat = 3,  // the heat bits of the clamps differ
  kTime = 4,  // not strictly increasing, or waypoint 0 not at 0
  kMinDt = 5,
  kStartPose = 6,  // waypoint 0 is no flat circular arc of this blade
  kEnvelope = 7,
  kSpeed = 8,
  kAcceleration = 9,
  kAngularSpeed = 10,
  kAngularAcceleration = 11,
  kChord = 12,
  kBlade = 13,     // OPEN announces an impossible blade or number of waypoints
  kHeldPose = 14,  // after a restart: the path does not lead through the pose the clamps are held at
  // The blade's equilibrium (robot/blade/blade_check.hpp), at the waypoint or on the way to it.
  kBladePlane = 15,   // the clamps do not lie in one plane
  kBladeReach = 16,   // the blade is pulled taut
  kBladeSnap = 17,    // the shape is lost
  kBladeYield = 18,   // bent beyond the yield strength
  kBladeMargin = 19,  // stable, with less than the smallest margin
};

[[nodiscard]] const char* describe(LimitCode code);

// Follows a stream of waypoints, across window borders. Copyable: check a window on a copy, keep the copy
// when the whole window holds. Never allocates or throws.
class LimitChecker {
 public:
  LimitChecker() = default;
  LimitChecker(const MotionLimits& limits, double blade_length_mm)
      : limits_(limits), blade_length_mm_(blade_length_mm) {}

  // The first limit the next waypoint breaks; the waypoint becomes part of the stream when there is none. The
  // strip starts at rest. Quantisation is allowed for: a register is off by up to 0.5 um and 0.5 us, so a
  // speed by sqrt(3) um / dt + 1 us / dt of itself and an acceleration by those of both steps over the mean
  // step.
  [[nodiscard]] LimitCode next(const Waypoint& waypoint);

  // The stop at the end of the stream, from the last step's speed to rest within that step.
  [[nodiscard]] LimitCode finish() const;

 private:
  struct Velocity {
    Eigen::Vector3d linear{0, 0, 0};   // mm/s
    Eigen::Vector3d angular{0, 0, 0};  // rad/s, cell axes
  };
  [[nodiscard]] LimitCode check_first(const Waypoint& waypoint) const;
  [[nodiscard]] LimitCode check_place(const Waypoint& waypoint) const;
  [[nodiscard]] LimitCode check_speed(const Velocity& v, double dt) const;
  [[nodiscard]] LimitCode check_change(const Velocity& from, const Velocity& to, double dt0,
                                       double dt1) const;

  MotionLimits limits_;
  double blade_length_mm_ = 0;
  bool started_ = false;
  Waypoint last_;
  Velocity va_, vb_;
  double last_dt_ = 0;  // s; 0 before the first step
};

}  // namespace hotblade::robot
