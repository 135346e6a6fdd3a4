// One strip and both arms at one place of its block.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pipeline/plan/arms/places.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/verify/refusal.hpp"
#include "robot/arm/arm_path.hpp"
#include "robot/arm/cell.hpp"

namespace hotblade::pipeline {

// How far a choice came before something stood in the way, in this order.
enum class ArmStage { kReach, kJointLimit, kSingular, kClearance, kTooSlow, kServed };

// One arm through all poses.
struct ArmChoice {
  ArmStage stage = ArmStage::kReach;
  double rank = 0;  // within a stage, the larger the nearer to the next
  HeldClamp held;
  std::vector<robot::JointAngles> joints;  // with turns
  robot::PathMargins margins;
  Refusal refusal;  // unless served
};

// Returns the best of all branches and ways round of the arm that holds a clamp.
[[nodiscard]] ArmChoice choose_branch(const Strip& strip, const robot::Cell& cell, const ArmPlace& place,
                                      bool clamp_b);

}  // namespace hotblade::pipeline
