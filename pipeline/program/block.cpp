#include "pipeline/program/block.hpp"

#include <algorithm>
#include <limits>

namespace hotblade::pipeline {

std::array<Eigen::Vector3d, 8> Block::corners() const {
  std::array<Eigen::Vector3d, 8> all;
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = frame.point(i & 1 ? size_mm.x() : 0, i & 2 ? size_mm.y() : 0, i & 4 ? size_mm.z() : 0);
  return all;
}

Block Block::seen_from(const Frame& plane) const {
  const Eigen::Vector3d normal = plane.normal();
  const auto turned = [&](const Eigen::Vector3d& d) -> Eigen::Vector3d {
    return {d.dot(plane.x), d.dot(plane.y), d.dot(normal)};
  };
  return {{turned(frame.origin - plane.origin), turned(frame.x), turned(frame.y)}, size_mm};
}

double Block::height_above_table_mm(const robot::Pose& design_to_cell) const {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& p : corners()) {
    const robot::Pose corner{p, Eigen::Quaterniond::Identity()};
    lowest = std::min(lowest, robot::transformed(design_to_cell, corner).p.z());
  }
  return lowest;
}

}  // namespace hotblade::pipeline
