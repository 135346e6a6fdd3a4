// What each of two arms does to cut a program's strips, in no maker's language: the blade is put in straight,
// where the arms stand on their own; from there on both move together.
//
// The way from the straight blade to the strip's first shape is one of exact elastica, its curvature growing
// from none, so that the blade is bent and never buckled. Waypoints that stand still are a wait, not moves;
// moves end at rest where the program rests, where heat changes and at the end.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "robot/arm/cell.hpp"

namespace hotblade::pipeline {

// Where a jaw is in the cell's frame. Joints and configuration where the arm is known.
struct RobotTarget {
  Pose pose{};
  std::array<double, kArmJoints> joints_deg{};
  // Quarters of joints 1, 4 and 6, and: axis 5 negative 1, wrist behind the lower arm 2, behind axis 1 4.
  std::array<int, 4> configuration{};
};

struct RobotStep {
  enum class Kind { kMove, kWait, kHeat };
  Kind kind = Kind::kMove;
  double seconds = 0;  // of a move or a wait
  // Of a move:
  RobotTarget to{};
  bool stops = false;
  int id = 0;  // the same for both arms
  // Of a change of heat, which stands behind a move that stops:
  bool on = false;
};

// A strip for one arm.
struct RobotJob {
  std::string strip;
  char clamp = 'a';
  bool flip = false;
  double blade_length_mm = 0;
  std::vector<std::string> texts;  // for the operator: block and where it stands; ASCII
  RobotTarget load;                // where the straight blade is put in
  std::vector<RobotStep> steps;
};

struct RobotTask {
  std::string id;                       // "R1" as names take it; without a cell "a" or "b"
  const robot::CellArm* arm = nullptr;  // absent: no cell was given, poses alone
  bool heats = false;                   // has the output of the heat: the first
  std::vector<RobotJob> jobs;
};

// Returns both arms' tasks. With a cell, which has to be that of the program's joints, poses are of the jaws
// as the cell has them; without, of the clamps, x along the blade from A to B. The cell has to outlive them.
// Throws Error (kNotCuttable) where an arm cannot take the straight blade.
[[nodiscard]] std::array<RobotTask, 2> robot_tasks(const Program& program, const robot::Cell* cell);

// Returns how far the jaws leave the straight way between waypoints at most when joints move evenly there,
// mm.
[[nodiscard]] double off_straight_mm(const Program& program, const robot::Cell& cell);

// Returns the text with every character that is not printable ASCII, and every quotation mark, replaced.
[[nodiscard]] std::string ascii(const std::string& text);

}  // namespace hotblade::pipeline
