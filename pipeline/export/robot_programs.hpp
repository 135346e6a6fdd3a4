// Robot programs in the languages of two makers of controllers, from a program as it stands.
//
// Both arms run one program each and have to stay together within a waypoint's time. Positions are in the
// cell frame as the arms' common work object. With a cell the tool is the jaw as cell.toml has it, names and
// numbers are the cell's, and the first point of a strip is given by joints; without, the tool is the clamp,
// x along the blade from A to B. A strip is a file, or several where it is long; the heat is switched where
// the motion stops; a question to the operator stands before each. None of these programs has been run on
// hardware. The same program gives the same text.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "pipeline/export/exported_file.hpp"
#include "pipeline/program/program.hpp"
#include "robot/arm/cell.hpp"

namespace hotblade::pipeline {

// By poses, with configurations where joints are known, or by joints.
enum class RobotMoves { kCartesian, kJoint };

// Returns ABB RAPID with MultiMove: hb_main_R1.mod and hb_S001_R1.mod, named by arm and strip, one task an
// arm, whose synchronised moves have the same \ID. A move's time is given with \T, so that both arms take the
// same time whatever their distances. ConfL is off: between waypoints arms turn little.
[[nodiscard]] std::vector<ExportedFile> rapid_programs(const Program& program, const robot::Cell* cell,
                                                       RobotMoves moves);

// Returns KUKA KRL: hb_main_R1.src and hb_S001_R1.src, splines from rest to rest with their times in time
// blocks, started together by signals. Orientations are A, B, C, turns about Z, Y', X'' in degrees.
[[nodiscard]] std::vector<ExportedFile> krl_programs(const Program& program, const robot::Cell* cell,
                                                     RobotMoves moves);

// Moves of a RAPID module at most; longer strips have several.
inline constexpr std::size_t kMostMoves = 5000;

// An orientation as turns about Z, then the new Y, then the new X, degrees; A and C in (-180, 180], B in
// [-90, 90]. At B = +-90 only A and C together count, and C is 0.
struct KukaAngles {
  double a = 0, b = 0, c = 0;
};
[[nodiscard]] KukaAngles kuka_angles(const Eigen::Quaterniond& q);

}  // namespace hotblade::pipeline
