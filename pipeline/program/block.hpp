// The foam block a strip is cut from: a box, and what stands inside or outside of it. mm.
#pragma once

#include <Eigen/Core>
#include <array>

#include "pipeline/program/frame.hpp"
#include "robot/pose/pose.hpp"

namespace hotblade::pipeline {

struct Block {
  Frame frame;  // its origin is a corner, the block's edges run along x, y and x cross y
  Eigen::Vector3d size_mm{0, 0, 0};

  // Returns the point in the block's axes, counted from its corner.
  [[nodiscard]] Eigen::Vector3d local(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d d = p - frame.origin;
    return {d.dot(frame.x), d.dot(frame.y), d.dot(frame.normal())};
  }
  // Returns the distance of the point from the block, mm; 0 inside and on its faces.
  [[nodiscard]] double distance_mm(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d q = local(p);
    return (-q).cwiseMax(q - size_mm).cwiseMax(0).norm();
  }
  [[nodiscard]] bool contains(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d q = local(p);
    return (q.array() >= 0).all() && (q.array() <= size_mm.array()).all();
  }
  // Returns the corners: bits 0, 1 and 2 of a corner's index stand for the far ends along x, y and x cross y.
  [[nodiscard]] std::array<Eigen::Vector3d, 8> corners() const;
  // Returns the same block in the axes of a plane: a point (u, v) of the plane is (u, v, 0) there.
  [[nodiscard]] Block seen_from(const Frame& plane) const;
  // Returns the height of the block's lowest corner where the block stands in the cell, mm.
  [[nodiscard]] double height_above_table_mm(const robot::Pose& design_to_cell) const;
};

}  // namespace hotblade::pipeline
