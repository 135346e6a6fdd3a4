// A triangle mesh wherever it lies, and one of its faces.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>

namespace hotblade::pipeline {

// Refers to a mesh that outlives it.
struct MeshView {
  std::span<const Eigen::Vector3d> vertices;
  std::span<const std::array<int, 3>> triangles;
};

// The corners of one face.
struct Facet {
  Eigen::Vector3d a, b, c;
  [[nodiscard]] Eigen::Vector3d normal() const { return (b - a).cross(c - a).stableNormalized(); }
  [[nodiscard]] double area() const { return 0.5 * (b - a).cross(c - a).norm(); }
};

// Returns the face with this index.
[[nodiscard]] inline Facet facet(const MeshView& mesh, int triangle) {
  const auto& t = mesh.triangles[static_cast<std::size_t>(triangle)];
  return {mesh.vertices[static_cast<std::size_t>(t[0])], mesh.vertices[static_cast<std::size_t>(t[1])],
          mesh.vertices[static_cast<std::size_t>(t[2])]};
}

}  // namespace hotblade::pipeline
