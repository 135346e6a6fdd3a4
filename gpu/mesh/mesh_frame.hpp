// Brings a mesh into its local frame: moved to its centre and scaled by a power of two into [-1, 1]^3, so
// that single precision keeps its digits for the mesh and scaling loses none.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "gpu/mesh/triangle_distance.hpp"

namespace hotblade::gpu {

struct MeshFrame {
  Eigen::Vector3d centre{0, 0, 0};
  double scale = 1;                       // a power of two
  std::vector<Eigen::Vector3d> vertices;  // (vertex - centre) * scale; unused vertices at the centre
  std::vector<std::array<int, 3>> triangles;

  [[nodiscard]] Eigen::Vector3d local(const Eigen::Vector3d& point) const { return (point - centre) * scale; }
  [[nodiscard]] TriangleDistance distance(int triangle, const Eigen::Vector3d& local_point) const {
    const auto& t = triangles[static_cast<std::size_t>(triangle)];
    return triangle_distance(
        {&vertices[static_cast<std::size_t>(t[0])], &vertices[static_cast<std::size_t>(t[1])],
         &vertices[static_cast<std::size_t>(t[2])]},
        local_point);
  }
};

// Returns the mesh in its frame. Throws std::logic_error when there is no triangle, an index is out of range
// or a coordinate is not finite.
[[nodiscard]] MeshFrame make_mesh_frame(std::span<const Eigen::Vector3d> vertices,
                                        std::span<const std::array<int, 3>> triangles);

}  // namespace hotblade::gpu
