// The joints of a program, measured again from its numbers alone: other code than that which found them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "robot/arm/cell.hpp"

namespace hotblade::pipeline {

// Joints hold a clamp when the jaw is as near to it as this.
inline constexpr double kJawOff_mm = 1e-6, kJawOff_rad = 1e-9;

struct JointCheck {
  double off_mm = 0, off_rad = 0;     // largest, of a jaw from its clamp
  double joint_margin_rad = 0;        // least, to a limit
  double wrist_rad = 0;               // least, between axes 4 and 6
  double speed_share = 0;             // largest, of what the cell allows a joint
  double acceleration_share = 0;      // the same, from rest to rest, with what the ramp of a hold adds
  double jerk_share = 0;              // the same, by third differences
  std::vector<std::string> nearest;   // "S003 arm to arm 412.0 mm", least of each kind of pair
  std::vector<std::string> breaches;  // "S003 at 12.05 s: ...", each kind of a strip once, where it is worst
};

// Returns what joints and clamps say together. Throws Error (kBadInput) where the program has no joints, or
// those of another cell.
[[nodiscard]] JointCheck check_joints(const Program& program, const robot::Cell& cell);

// Returns what was measured as `hotblade verify --json` has it.
[[nodiscard]] nlohmann::ordered_json to_json(const JointCheck& check);

}  // namespace hotblade::pipeline
