// Where a block stands on the table of the cell.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pipeline/program/block.hpp"
#include "robot/pose/pose.hpp"

namespace hotblade::pipeline {

// Where a block stands on the table, as whoever sets it up is told: x to the right and y to the back as seen
// from the front, z up, mm.
struct BlockPlace {
  // The block in axes of its own, its y axis along theirs or against it: the cell's, turned about their
  // origin and z by `turned_rad`, counter-clockwise as seen from above, by a right angle at most.
  Eigen::AlignedBox3d box;
  double turned_rad = 0;
  Eigen::Vector3d corner{0, 0, 0};  // the left front lower one of the box, in the cell's axes

  // Returns a pose of the cell's axes in those of the box.
  [[nodiscard]] robot::Pose in_box(const robot::Pose& in_cell) const;
};

[[nodiscard]] BlockPlace standing_place(const Block& block, const robot::Pose& design_to_cell);

}  // namespace hotblade::pipeline
