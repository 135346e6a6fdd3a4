// Arms, their tools and what stands around them, as meshes that move with a program.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
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
  bool by_margin = false;  // links are coloured by what their joints have to their limits
};

enum class CellPartKind { kFirstArm, kSecondArm, kTool, kStanding };

// A body in a frame of its own, and where that frame is among the design.
struct CellPart {
  std::string name;  // "arm_R1_link_3"
  CellPartKind kind = CellPartKind::kStanding;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  std::optional<double> margin_rad;  // of the joint that moves a link, where that is its colour
};

// Where a part is at a pose, and its joint's margin, where that is its colour.
struct CellPlace {
  Eigen::Isometry3d at;
  std::optional<double> margin_rad;
};

// Margins from which a link is as green as it gets, and at which it is red: what places are good enough at
// (pipeline/plan/arms), with a half more, and none.
inline constexpr double kGreenMargin_rad = 30 * robot::kDegree_rad;

// Returns all parts where a pose of a strip with joints has them. Throws std::logic_error without joints.
[[nodiscard]] std::vector<CellPart> cell_parts(const CellShown& shown, const Strip& strip, std::size_t pose);

// Returns the places alone, in the same order; of what stands around too.
[[nodiscard]] std::vector<CellPlace> cell_places(const CellShown& shown, const Strip& strip,
                                                 std::size_t pose);

}  // namespace hotblade::pipeline::preview
