// Arms, their tools and what stands around them, as meshes that move with a program.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "robot/arm/cell.hpp"
#include "robot/arm/clearance.hpp"

namespace hotblade::pipeline::preview {

// The cell of a program's joints, with what stands around each strip in the cell's frame; the block is not
// among it.
struct CellShown {
  const robot::Cell* cell = nullptr;
  std::map<std::string, std::vector<robot::Standing>> standing;  // by strip
};

enum class CellPartKind { kFirstArm, kSecondArm, kTool, kStanding };

// A body in a frame of its own, and where that frame is among the design.
struct CellPart {
  std::string name;  // "arm_R1_link_3"
  CellPartKind kind = CellPartKind::kStanding;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
};

// Returns all parts where a pose of a strip with joints has them. Throws std::logic_error without joints.
[[nodiscard]] std::vector<CellPart> cell_parts(const CellShown& shown, const Strip& strip,
                                               const BladePose& pose);

// Returns the places alone, in the same order; of what stands around too.
[[nodiscard]] std::vector<Eigen::Isometry3d> cell_places(const CellShown& shown, const Strip& strip,
                                                         const BladePose& pose);

}  // namespace hotblade::pipeline::preview
