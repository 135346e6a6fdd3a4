// Solid shapes of links, tools and obstacles. mm.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <variant>
#include <vector>

namespace hotblade::robot {

// About the origin of the shape's place, as URDF has them.
struct Box {
  Eigen::Vector3d size_mm{0, 0, 0};
};
struct Cylinder {  // along z
  double radius_mm = 0, length_mm = 0;
};
struct Sphere {
  double radius_mm = 0;
};
struct Mesh {
  std::string file;  // as the model names it
  std::vector<std::array<Eigen::Vector3d, 3>> triangles;
};

struct Shape {
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  std::variant<Box, Cylinder, Sphere, Mesh> solid;
};

// Returns the farthest that the shape gets from its place's origin; of a mesh, that its corners get.
[[nodiscard]] double radius_mm(const Shape& shape);

// Returns how deep a point is inside a box, cylinder or sphere, mm; negative outside, by at least the
// distance along one axis. Throws std::logic_error for a mesh.
[[nodiscard]] double depth_mm(const Shape& shape, const Eigen::Vector3d& point);

}  // namespace hotblade::robot
