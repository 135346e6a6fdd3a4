// The axes that all ribs of a chain or strip share, carried along by their planes.
#pragma once

#include "pipeline/program/program.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::pipeline {

// A rib's point (u, v) lies at u x + v y from its plane's origin. The directions are those of the plane at
// offset 0; parallel planes keep them, a fan turns them. x cross y = +-sweep, which points to larger offsets.
struct RibAxes {
  surface::PlaneFamily planes;
  Eigen::Vector3d sweep{0, 0, 0}, x{0, 0, 0}, y{0, 0, 0};

  // Returns the plane at an offset: axes x, y there; origin on the line along the sweep through the planes'
  // centre, or on the fan's axis.
  [[nodiscard]] Frame plane(double offset_mm) const;
  // Returns the plane through a point, which takes no angle.
  [[nodiscard]] Frame plane_at(const Eigen::Vector3d& p) const;
  // Returns the offset of a frame with these axes, wherever its origin lies in its plane.
  [[nodiscard]] double offset(const Frame& frame) const;
  // Returns how far the point (u, v) moves for each mm of offset: 1 for parallel planes, less inside a fan.
  [[nodiscard]] double rate(const Eigen::Vector2d& q) const;
};

}  // namespace hotblade::pipeline
