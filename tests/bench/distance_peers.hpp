// The peers of the distance benchmarks, behind plain arrays: they are compiled for this machine's processor,
// ours for any.
#pragma once

#include <array>
#include <memory>
#include <vector>

namespace hotblade::bench {

struct PeerMesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<int, 3>> triangles;
};

// Nearest distance to the mesh of each point, on as many threads as oneTBB allows.
class Peer {
 public:
  virtual ~Peer() = default;
  virtual void query(const std::vector<std::array<double, 3>>& points,
                     std::vector<double>& distances) const = 0;
};

// Embree's point query over single-precision triangles, each query started from the triangle before.
[[nodiscard]] std::unique_ptr<Peer> embree_from_last(const PeerMesh& mesh);
// CGAL's AABB tree with the accelerated start.
[[nodiscard]] std::unique_ptr<Peer> cgal_tree(const PeerMesh& mesh);
// VTK's static cell locator.
[[nodiscard]] std::unique_ptr<Peer> vtk_locator(const PeerMesh& mesh);

}  // namespace hotblade::bench
