// What a program says of the two arms that hold its clamps (docs/program.md). mm, rad, s.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robot/pose/pose.hpp"

namespace hotblade::pipeline {

inline constexpr std::size_t kArmJoints = 6;
using ArmJoints = std::array<double, kArmJoints>;

struct ProgramJoint {
  std::string name;
  double min_rad = 0, max_rad = 0, speed_rad_s = 0, acceleration_rad_s2 = 0, jerk_rad_s3 = 0;
};

struct ProgramArm {
  std::string id, model, files_sha256;
  robot::Pose base;  // base_link in the cell
  robot::Pose jaw;   // in the flange's frame
  std::array<ProgramJoint, kArmJoints> joints;
};

// The cell that a program's joints belong to; `sha256` is that of this part's text without it.
struct ProgramCell {
  std::string name, sha256;
  std::array<ProgramArm, 2> arms;
};

// Which arm holds a clamp through a strip, and how.
struct HeldClamp {
  std::string arm;
  std::array<int, 3> branch{1, 1, 1};   // shoulder, elbow, wrist: 1 or -1
  bool flip = false;                    // the blade lies turned by 180 degrees in the jaw
  std::array<int, kArmJoints> turns{};  // whole turns added to the branch's angles
};

// How a strip's arms do over all of its poses.
struct StripArms {
  HeldClamp a, b;
  struct Nearest {
    double value = 0;
    std::string arm;
    int joint = 0;  // from 1; of the wrist 5
    double t = 0;   // s
  };
  Nearest joint_margin_rad;  // to a joint's limit
  Nearest wrist_rad;         // from axes 4 and 6 in one line
  // The farthest wrist: its centre's distance from axis 2, as a share of what the arm reaches. Absent in
  // programs made before it was looked at.
  std::optional<Nearest> reach{};
  // The least distance of each kind of pair (robot::PairKind) and when; kinds that come no nearer than
  // robot::kWidest_mm are left out.
  struct NearestPair {
    std::string kind;
    double mm = 0, t = 0;
  };
  std::vector<NearestPair> nearest_mm;
  double raise_mm = 0;                       // what the block stands higher for the arms
  double dx_mm = 0, dy_mm = 0, yaw_rad = 0;  // how it was turned about the cell's vertical axis and moved
  // What the arms take longer than the plan's clamps, s: speeds and accelerations, and jerk.
  double joints_s = 0, jerk_s = 0;
  // When the clamps alone would meet each pose; empty where the arms meet all of them then.
  std::vector<double> clamp_times_s{};
};

// The joints of both arms at one pose.
struct ClampJoints {
  ArmJoints a{}, b{};
};

}  // namespace hotblade::pipeline
