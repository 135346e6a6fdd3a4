// Builds a wide bounding-volume tree over a mesh in single precision, for searches on the host and on
// devices.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "gpu/kernels/mesh_tree.h"

namespace hotblade::gpu {

struct MeshTree {
  std::vector<TreeNode> nodes;  // the root is nodes[0]
  std::vector<TrianglePacket> packets;
};

// Returns the tree of a mesh whose vertices lie in [-1, 1]^3. The tree is the same whatever the number of
// threads. Boxes are split where the surface area heuristic says, by its cost over bins of the centres (Wald
// 2007).
[[nodiscard]] MeshTree build_mesh_tree(std::span<const Eigen::Vector3d> vertices,
                                       std::span<const std::array<int, 3>> triangles);

}  // namespace hotblade::gpu
