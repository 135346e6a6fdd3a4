#include "robot/arm/shape.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hotblade::robot {
namespace {

struct Radius {
  double operator()(const Box& box) const { return box.size_mm.norm() / 2; }
  double operator()(const Cylinder& c) const { return std::hypot(c.radius_mm, c.length_mm / 2); }
  double operator()(const Sphere& sphere) const { return sphere.radius_mm; }
  double operator()(const Mesh& mesh) const {
    double farthest = 0;
    for (const auto& triangle : mesh.triangles) {
      for (const Eigen::Vector3d& corner : triangle) farthest = std::max(farthest, corner.norm());
    }
    return farthest;
  }
};

struct Depth {
  Eigen::Vector3d p;
  double operator()(const Box& box) const { return (box.size_mm / 2 - p.cwiseAbs()).minCoeff(); }
  double operator()(const Cylinder& c) const {
    return std::min(c.radius_mm - p.head<2>().norm(), c.length_mm / 2 - std::abs(p.z()));
  }
  double operator()(const Sphere& sphere) const { return sphere.radius_mm - p.norm(); }
  double operator()(const Mesh&) const { throw std::logic_error("depth_mm: not of a mesh"); }
};

}  // namespace

double radius_mm(const Shape& shape) {
  return std::visit(Radius{}, shape.solid);
}

double depth_mm(const Shape& shape, const Eigen::Vector3d& point) {
  return std::visit(Depth{shape.place.inverse() * point}, shape.solid);
}

}  // namespace hotblade::robot
