// Robot programs in the languages of two makers of controllers, from a program as it stands.
//
// Both arms run one program each and have to stay together within a waypoint's time. Either language keeps
// positions in the cell frame as the arms' common work object, tool centre point in the clamp's jaw with x
// along the blade from A to B, y in the blade's plane; the heat on an output of arm A; a halt between
// strips. None of these programs has been run on hardware: signals, tool and work object have to be set to
// those of the cell. The same program gives the same text.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "pipeline/export/exported_file.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Returns ABB RAPID with MultiMove: hb_arm_a.mod and hb_arm_b.mod, one task each, whose synchronised moves
// have the same \ID. A move's time is given with \T, so that both arms take the same time whatever their
// distances; ConfL and ConfJ are off, because the clamps turn little and the configuration is the cell's
// choice.
[[nodiscard]] std::vector<ExportedFile> rapid_programs(const Program& program);

// Returns KUKA KRL: hb_arm_a.src and hb_arm_b.src, a spline a strip with its times in a time block, started
// together by signals. Orientations are A, B, C, turns about Z, Y', X'' in degrees.
[[nodiscard]] std::vector<ExportedFile> krl_programs(const Program& program);

// A waypoint's times are whole ones, s.
inline constexpr double kMicrosecond = 1e-6;

// Returns the clamp that an arm, 'A' or 'B', holds.
[[nodiscard]] inline const Pose& clamp_of(const robot::Waypoint& waypoint, char arm) {
  return arm == 'A' ? waypoint.a : waypoint.b;
}

// An orientation as turns about Z, then the new Y, then the new X, degrees; A and C in (-180, 180], B in
// [-90, 90]. At B = +-90 only A and C together count, and C is 0.
struct KukaAngles {
  double a = 0, b = 0, c = 0;
};
[[nodiscard]] KukaAngles kuka_angles(const Eigen::Quaterniond& q);

}  // namespace hotblade::pipeline
