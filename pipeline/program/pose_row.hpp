// A pose as seven numbers in a row: a Pose has a gap of eight bytes, of which a job's million waypoints have
// two each.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robot/pose/pose.hpp"

namespace hotblade::pipeline {

// A Pose, which it turns into: x y z in mm, then w x y z of the unit quaternion, as program files and Python
// have them.
struct PoseRow {
  PoseRow() = default;
  PoseRow(const robot::Pose& pose) : p(pose.p), w(pose.q.w()), v(pose.q.vec()) {}
  operator robot::Pose() const { return {p, q()}; }

  [[nodiscard]] Eigen::Quaterniond q() const { return {w, v.x(), v.y(), v.z()}; }

  Eigen::Vector3d p{0, 0, 0};
  double w = 1;
  Eigen::Vector3d v{0, 0, 0};
};

}  // namespace hotblade::pipeline
