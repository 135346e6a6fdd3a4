#include "robot/arm/cell.hpp"

namespace hotblade::robot {

Eigen::Isometry3d jaw_in_flange(const ArmTool& tool) {
  Eigen::Isometry3d jaw = Eigen::Isometry3d::Identity();
  jaw.linear().col(0) = tool.jaw_x;
  jaw.linear().col(1) = tool.jaw_y;
  jaw.linear().col(2) = tool.jaw_x.cross(tool.jaw_y);
  jaw.translation() = tool.jaw_p_mm;
  return jaw;
}

}  // namespace hotblade::robot
