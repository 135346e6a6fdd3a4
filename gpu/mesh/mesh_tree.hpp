// Builds a wide bounding-volume tree over a mesh in single precision, for searches on the host and on
// devices.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "gpu/kernels/mesh_tree.h"

namespace hotblade::gpu {

class MeshTree {
 public:
  MeshTree() = default;
  // With packets that are not set yet.
  MeshTree(std::vector<TreeNode> nodes, std::size_t packets)
      : nodes_(std::move(nodes)),
        packets_(std::make_unique_for_overwrite<TrianglePacket[]>(packets)),
        packet_count_(packets) {}

  [[nodiscard]] std::span<const TreeNode> nodes() const { return nodes_; }  // the root is nodes()[0]
  [[nodiscard]] std::span<const TrianglePacket> packets() const { return {packets_.get(), packet_count_}; }
  [[nodiscard]] TrianglePacket& packet(std::size_t i) { return packets_[i]; }

 private:
  std::vector<TreeNode> nodes_;
  std::unique_ptr<TrianglePacket[]> packets_;
  std::size_t packet_count_ = 0;
};

// Returns the tree of a mesh whose vertices lie in [-1, 1]^3. The tree is the same whatever the number of
// threads. Boxes are split where the surface area heuristic says, by its cost over bins of the centres (Wald
// 2007).
[[nodiscard]] MeshTree build_mesh_tree(std::span<const Eigen::Vector3d> vertices,
                                       std::span<const std::array<int, 3>> triangles);

}  // namespace hotblade::gpu
