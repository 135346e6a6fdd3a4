// Clamp waypoints as data for other programs: cell frame, mm, s, unit quaternions (w, x, y, z).
#pragma once

#include "pipeline/export/exported_file.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// One CSV file a strip with a heading line:
//   index,t_s,phase,heat,ax_mm,ay_mm,az_mm,aqw,aqx,aqy,aqz,bx_mm,...,bqz
[[nodiscard]] std::vector<ExportedFile> waypoint_csv(const Program& program);

// One CSV file a strip with the joints of both arms, in degrees:
//   index,t_s,phase,heat,a1_deg,...,a6_deg,b1_deg,...,b6_deg
// Throws Error (kBadInput) for a program without joints.
[[nodiscard]] std::vector<ExportedFile> joints_csv(const Program& program);

// One JSON file a strip in the data format of COMPAS 2: frames of both clamps (x along the blade from A to B,
// y in the blade's plane), times, phases, and the block as a compas.geometry/Box.
[[nodiscard]] std::vector<ExportedFile> waypoint_compas(const Program& program);

}  // namespace hotblade::pipeline
