#include "pipeline/verify/clamp_error.hpp"

#include <algorithm>
#include <array>
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

double ClampResponse::at(double share) {
  MachineSettings machine = machine_;
  machine.clamp_error_mm *= share;
  machine.clamp_error_rad *= share;
  const double length = pose_->blade.length;
  const elastica::SensitivityOptions errors{machine.clamp_error_mm, machine.clamp_error_rad};
  const auto straight = [&](bool keeps_side) {
    return elastica::straight_response_mm(length, slack_mm(*pose_, machine), keeps_side, errors);
  };
  if (nearly_straight(*pose_, machine)) return straight(straight_mm_ > worst_clamp_error_mm(machine, length));
  if (!first_order_mm_) {
    const auto [from, to] = pose_->foam.value_or(std::array{0.0, length});
    first_order_mm_ =
        elastica::sensitivity(pose_->blade, {machine_.clamp_error_mm, machine_.clamp_error_rad, from, to})
            .total_mm;
  }
  const double moved = share * *first_order_mm_;
  return std::isfinite(moved) ? moved : straight(false);
}

double clamp_error_mm(const BladePose& pose, double straight_mm, const MachineSettings& machine) {
  return ClampResponse(pose, straight_mm, machine).at(1);
}

}  // namespace hotblade::pipeline
