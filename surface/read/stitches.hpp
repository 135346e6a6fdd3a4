// Finds border vertices that almost meet those of another border, and would close a gap when joined.
#pragma once

#include <vector>

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {

struct Stitches {
  std::vector<int> vertex;     // per vertex: the one that stands for it, itself where nothing is joined
  std::size_t joined = 0;      // vertices replaced by another
  int first = -1;              // the lowest of them
  double largest_move_mm = 0;  // from a replaced vertex to the one that stands for it
};

// Returns which border vertices within distance_mm of each other to join, the closest first, each group to
// its lowest number. The two ends of an edge are never joined, so no edge is lost to a distance larger than
// the mesh.
[[nodiscard]] Stitches find_stitches(const TriangleMesh& mesh, double distance_mm);

}  // namespace hotblade::surface
