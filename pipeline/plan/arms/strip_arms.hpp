// One strip and both arms at one place of its block.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "pipeline/verify/refusal.hpp"
#include "robot/arm/arm_path.hpp"
#include "robot/arm/cell.hpp"

namespace hotblade::pipeline {

// Where a block may stand, and which arm holds clamp A.
struct ArmPlace {
  double raise_mm = 0;
  bool swapped = false;                      // the second arm holds clamp A
  double dx_mm = 0, dy_mm = 0, yaw_rad = 0;  // turned about the cell's vertical axis, then moved
};

// Returns the flange of the arm that holds a clamp, in its base_link: clamp A as it is, clamp B turned by 180
// degrees about its plane's normal, a flipped jaw by 180 degrees about the blade's tangent besides.
[[nodiscard]] Eigen::Isometry3d flange_of(const robot::CellArm& arm, const Pose& design_to_cell,
                                          const BladePose& pose, bool clamp_b, bool flip);

// Returns the strip's place in the cell, turned, moved and raised; and what it was before.
[[nodiscard]] Pose placed(const Pose& design_to_cell, const ArmPlace& place);
[[nodiscard]] Pose unplaced(const Pose& design_to_cell, const ArmPlace& place);

// How good a place is by every so many poses, 1 or more is good enough in everything: the least of joint
// margin over 20 degrees, wrist over 20, elbow over 10, shoulder over 200 mm, of both arms' best branches.
// Negative: a pose is out of reach or a limit is broken.
[[nodiscard]] double score(const Strip& strip, const robot::Cell& cell, const ArmPlace& place);

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
