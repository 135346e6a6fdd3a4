// How triangles of a mesh lie to each other.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {

// Square to a face, as long as twice its area.
[[nodiscard]] inline Eigen::Vector3d across_face(const TriangleMesh& mesh, int face) {
  const auto& [a, b, c] = mesh.triangles()[static_cast<std::size_t>(face)];
  const auto at = [&](int v) -> const Eigen::Vector3d& {
    return mesh.vertices()[static_cast<std::size_t>(v)];
  };
  return (at(b) - at(a)).cross(at(c) - at(a));
}

// The angle of two faces.
[[nodiscard]] inline double turn_between(const TriangleMesh& mesh, int face, int other) {
  const Eigen::Vector3d m = across_face(mesh, face).stableNormalized(),
                        n = across_face(mesh, other).stableNormalized();
  return std::atan2(m.cross(n).norm(), m.dot(n));
}

}  // namespace hotblade::surface
