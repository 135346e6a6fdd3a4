#include "pipeline/plan/motion/rib_clamp_error.hpp"

#include <algorithm>

#include "pipeline/plan/motion/rib_poses.hpp"
#include "pipeline/program/clamps.hpp"
#include "pipeline/verify/clamp_error.hpp"

namespace hotblade::pipeline {

double rib_clamp_error_mm(const StripPlan& strip, const MachineSettings& machine) {
  double most_mm = 0;
  for (const BladePose& pose : rib_poses(strip, machine)) {
    const ClampPoses holding = clamps(pose.blade, pose.frame);
    const double slack_mm = strip.blade_length_mm - (holding.b.p - holding.a.p).norm();
    most_mm = std::max(most_mm, clamp_error_mm(pose, slack_mm, machine));
  }
  return most_mm;
}

}  // namespace hotblade::pipeline
