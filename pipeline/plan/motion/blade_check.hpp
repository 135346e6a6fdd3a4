// The limits of the blade's shape, measured on every pose of a strip: bending, loads, stability, weight,
// clamps and free parts. The poses between the ribs are checked like the ribs themselves.
#pragma once

#include "pipeline/plan/motion/motion.hpp"

namespace hotblade::pipeline {

// Fills the loads of motion.poses and the extremes of `motion`, and adds a refusal for each limit that a pose
// exceeds, of the pose where it is worst. A coarse look leaves out what the clamps' errors do.
void check_blade(const StripPlan& strip, const Settings& settings, MotionLook look, BladeMotion& motion);

}  // namespace hotblade::pipeline
