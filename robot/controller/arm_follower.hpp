// The controller's own way to an arm's joints: from those that it has to those that hold the next place, by
// Newton's method on the axes as the model has them.
//
// The planner takes joints from a closed form, all eight solutions at once (robot/arm/arm.hpp). Here nothing
// is chosen: joints go on from where they are, as those of the arm do. mm, rad, in the cell's frame.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "robot/arm/cell.hpp"

namespace hotblade::robot {

[[nodiscard]] Eigen::Isometry3d isometry(const Pose& pose);

// An arm with its joints at some angles.
struct ArmPosture {
  JointAngles q = JointAngles::Zero();
  std::array<Eigen::Isometry3d, kJoints + 1> links;  // motions of base_link and links 1 to 6 from zero
  std::array<Eigen::Vector3d, kJoints> axis, point_mm;
  Eigen::Vector3d wrist_mm{0, 0, 0};  // where axes 4, 5 and 6 meet
  Eigen::Isometry3d jaw;
};
[[nodiscard]] ArmPosture posture_of(const CellArm& arm, const JointAngles& q);

// How far an arm is from singular, each with a sign that changes where the arm goes through: the angle
// between axes 4 and 6, the elbow's from stretched or folded, and the wrist's centre from axis 1.
struct ArmBends {
  double wrist_rad = 0, elbow_rad = 0, shoulder_mm = 0;
};
[[nodiscard]] ArmBends bends_of(const ArmPosture& posture);

// How far a jaw is from a place.
struct JawOff {
  Eigen::Vector3d way_mm{0, 0, 0}, turn_rad{0, 0, 0};  // from where the jaw is to it, the shorter turn
};
[[nodiscard]] JawOff off(const ArmPosture& posture, const Eigen::Isometry3d& jaw);

struct FollowedJoints {
  JointAngles q = JointAngles::Zero();
  bool there = false;
  double short_mm = 0;  // not there: the nearest that the jaw comes
};
// Returns the joints nearest to `from` that bring the jaw to a place.
[[nodiscard]] FollowedJoints follow(const CellArm& arm, const JointAngles& from,
                                    const Eigen::Isometry3d& jaw);

// Returns how far each joint turns at most for a jaw that is off by so much, rad.
[[nodiscard]] JointAngles turned_by_rounding(const ArmPosture& posture, double way_mm, double turn_rad);

}  // namespace hotblade::robot
