// The cross product in the plane.
#pragma once

#include <Eigen/Core>

namespace hotblade::elastica {

// Returns the area that two vectors span, with the sign of the turn from the first to the second.
[[nodiscard]] inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace hotblade::elastica
