// An arm along a path of its flange: eight branches, each followed from pose to pose.
//
// A strip's path is fixed and cut in one go, so an arm keeps its branch from the first pose to the last: what
// would need another half way goes through a singularity, and is no path.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "robot/arm/arm.hpp"

namespace hotblade::robot {

// The joints of one branch, up to the first pose that the branch does not have.
using BranchPath = std::vector<JointAngles>;

// Returns all branches along the path. Each joint takes the turn nearest to the pose before, the first pose
// those in (-pi, pi]; where the wrist is straight joint 4 stays as it was.
[[nodiscard]] std::array<BranchPath, kBranches> follow_branches(const Arm& arm,
                                                                std::span<const Eigen::Isometry3d> flanges);

using Turns = std::array<int, kJoints>;

// Returns the whole turns that leave each joint of a path the most of its limits; towards none on ties.
[[nodiscard]] Turns fit_turns(const Arm& arm, std::span<const JointAngles> path);

// Returns the joints with the turns added.
[[nodiscard]] JointAngles with_turns(const JointAngles& q, const Turns& turns);

// The least of a path, and where.
struct Least {
  double value = 0;
  std::size_t pose = 0, joint = 0;
};
struct PathMargins {
  Least joint_rad;                          // to a limit; negative beyond
  Least wrist_rad, elbow_rad, shoulder_mm;  // from singular, `joint` unused
};

// Returns the least of a path with at least one pose.
[[nodiscard]] PathMargins path_margins(const Arm& arm, std::span<const JointAngles> path);

}  // namespace hotblade::robot
