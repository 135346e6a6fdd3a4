// The vault with joints of two arms, made without arms: numbers to be written and read.
#pragma once

#include <string>

#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline::testing {

inline Program with_joints() {
  Program program = testing::vault_program({.strips = 2});
  ProgramCell cell{"a \"cell\"", std::string(64, 'a'), {}};
  for (std::size_t k = 0; k < 2; ++k) {
    ProgramArm& arm = cell.arms[k];
    arm.id = "R" + std::to_string(k + 1);
    arm.model = "arms/x.urdf";
    arm.files_sha256 = std::string(64, 'b');
    arm.base.p = {-2100.0, 0.1, 0};
    for (std::size_t i = 0; i < kArmJoints; ++i)
      arm.joints[i] = {"joint_" + std::to_string(i + 1), -3, 3, 2.5, 1.5, 15};
  }
  program.cell = cell;
  for (Strip& strip : program.strips) {
    StripArms arms;
    arms.a = {"R1", {1, -1, 1}, false, {0, 0, 0, -1, 0, 2}};
    arms.b = {"R2", {-1, 1, -1}, true, {}};
    arms.joint_margin_rad = {0.5, "R1", 4, 1.25};
    arms.wrist_rad = {0.25, "R2", 5, 0.5};
    arms.nearest_mm = {{"arm_arm", 412.5, 1.5}, {"blade", 61.25, 0.5}};
    arms.raise_mm = 200;
    arms.reach = StripArms::Nearest{0.75, "R2", 0, 0.25};
    arms.dx_mm = -150;
    arms.dy_mm = 300;
    arms.yaw_rad = 0.5;
    arms.joints_s = 1.5;
    arms.jerk_s = 0.5;
    strip.arms = arms;
    for (std::size_t i = 0; i < strip.poses.size(); ++i) {
      ClampJoints joints;
      for (std::size_t k = 0; k < kArmJoints; ++k) {
        joints.a[k] = 0.1 * static_cast<double>(k) + 0.01 * static_cast<double>(i);
        joints.b[k] = -joints.a[k] / 3;
      }
      strip.joints.push_back(joints);
    }
  }
  return program;
}

}  // namespace hotblade::pipeline::testing
