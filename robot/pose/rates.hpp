// How fast a clamp goes from one waypoint to the next, and how suddenly that changes: the differences that a
// controller checks against its limits and that a plan is timed by.
#pragma once

#include <Eigen/Core>

#include "robot/pose/pose.hpp"

namespace hotblade::robot {

// A clamp's velocity on a step, which is constant there: positions are linear, orientations a slerp.
struct ClampRates {
  Eigen::Vector3d linear{0, 0, 0};   // mm/s
  Eigen::Vector3d angular{0, 0, 0};  // rad/s, in the axes both poses are given in
};

// Returns the velocity that carries a clamp from one pose to the other in dt_s, turning by the shorter arc.
[[nodiscard]] ClampRates rates_between(const Pose& from, const Pose& to, double dt_s);

// A clamp's acceleration at a waypoint.
struct ClampAccelerations {
  double linear_mm_s2 = 0, angular_rad_s2 = 0;
};

// Returns the change of velocity from a step of dt0_s to the next of dt1_s over the time between their
// middles.
[[nodiscard]] ClampAccelerations accelerations_between(const ClampRates& from, const ClampRates& to,
                                                       double dt0_s, double dt1_s);

}  // namespace hotblade::robot
