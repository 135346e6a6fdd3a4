#include "pipeline/verify/clamp_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "elastica/blade/continuation.hpp"
#include "elastica/blade/sensitivity.hpp"
#include "elastica/blade/taut.hpp"

namespace hotblade::pipeline {

namespace {

using robot::ClampPoses;

double slack_mm(const BladePose& pose, const MachineSettings& machine) {
  const ClampPoses holding = robot::held({pose.a, pose.b}, machine.clamps);
  return pose.blade.length - (holding.b.p - holding.a.p).norm();
}

}  // namespace

double worst_clamp_error_mm(const MachineSettings& machine, double blade_length_mm) {
  return std::numbers::sqrt2 *
         std::hypot(machine.clamp_error_mm, 0.5 * blade_length_mm * machine.clamp_error_rad);
}

bool nearly_straight(const BladePose& pose, const MachineSettings& machine) {
  constexpr double kErrors = 10;  // of the clamps'
  return slack_mm(pose, machine) <
         std::max(elastica::kNearlyTautSlack * pose.blade.length, kErrors * machine.clamp_error_mm);
}

double clamp_error_mm(const BladePose& pose, double straight_mm, const MachineSettings& machine) {
  const elastica::SensitivityOptions errors{machine.clamp_error_mm, machine.clamp_error_rad};
  const double length = pose.blade.length, slack = slack_mm(pose, machine);
  const bool keeps_side = straight_mm > worst_clamp_error_mm(machine, length);
  const double moved = nearly_straight(pose, machine)
                           ? elastica::straight_response_mm(length, slack, keeps_side, errors)
                           : elastica::sensitivity(pose.blade, errors).total_mm;
  return std::isfinite(moved) ? moved : elastica::straight_response_mm(length, slack, false, errors);
}

}  // namespace hotblade::pipeline
