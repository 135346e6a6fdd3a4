// Bodies as triangles, and how far two of them are apart. mm.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <vector>

#include "robot/arm/shape.hpp"

namespace hotblade::robot {

using Triangle = std::array<Eigen::Vector3d, 3>;

// Returns the shape's surface in its body's frame. Boxes and meshes are as they are; cylinders and spheres
// are prisms and polyhedra around them, at most 0.5 and 4 % of the radius larger.
[[nodiscard]] std::vector<Triangle> triangles_of(const Shape& shape);

// A body that moves as one. It shares what it holds with its copies.
class Solid {
 public:
  // The shapes together; each has an inside.
  explicit Solid(const std::vector<Shape>& shapes);
  // An open sheet without an inside. Throws std::logic_error where there is no triangle.
  explicit Solid(std::vector<Triangle> sheet);

  // A sphere around all of it.
  [[nodiscard]] const Eigen::Vector3d& centre() const;
  [[nodiscard]] double radius_mm() const;
  [[nodiscard]] const std::vector<Triangle>& triangles() const;
  // Returns whether a point is inside one of the shapes.
  [[nodiscard]] bool holds(const Eigen::Vector3d& point) const;
  // Returns a corner of each shape, or of the sheet.
  [[nodiscard]] std::vector<Eigen::Vector3d> corners() const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
  friend double distance_mm(const Solid&, const Eigen::Isometry3d&, const Solid&, const Eigen::Isometry3d&,
                            double);
};

// Returns the distance of two bodies' surfaces at their places; 0 where they cut each other. From
// `capped_mm` on it is a lower bound that is at least `capped_mm`. A body that lies inside of another, and
// cuts no surface of it, has a distance: `one_inside_other` says so.
[[nodiscard]] double distance_mm(const Solid& a, const Eigen::Isometry3d& at_a, const Solid& b,
                                 const Eigen::Isometry3d& at_b, double capped_mm);

// Returns whether a shape of one body has a corner inside the other.
[[nodiscard]] bool one_inside_other(const Solid& a, const Eigen::Isometry3d& at_a, const Solid& b,
                                    const Eigen::Isometry3d& at_b);

}  // namespace hotblade::robot
