// Border vertices that almost meet those of another border, and would close a gap when joined.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "surface/read/face_links.hpp"

namespace hotblade::surface {

struct Stitches {
  std::vector<int> vertex;     // per vertex: the one that stands for it, itself where nothing is joined
  std::size_t joined = 0;      // vertices replaced by another
  int first = -1;              // the lowest of them
  double largest_move_mm = 0;  // from a replaced vertex to the one that stands for it
};

// Joins border vertices within distance_mm of each other, the closest first, to the one of the lowest number.
// The two ends of an edge are never joined, so no edge is lost to a distance larger than the mesh.
[[nodiscard]] Stitches find_stitches(std::span<const Eigen::Vector3d> vertices,
                                     std::span<const std::array<int, 3>> triangles, const FaceLinks& links,
                                     double distance_mm);

}  // namespace hotblade::surface
