// Finds the vertices of a mesh whose triangles lie side by side about them.
#pragma once

#include <vector>

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {

// Tells of a vertex whether it is proved that no two of its triangles cross: it is inside the surface, and
// seen along one of the axes its triangles turn about it once, all in one sense, so that two of them have in
// common what they have as neighbours only. That is told in numbers that rounding cannot have turned
// (Shewchuk 1997, the filter of orient2d), and holds at nearly every vertex of a smooth surface; it does
// nowhere on a mesh that is no plain surface. A vertex is looked at when it is first asked for.
class SpreadFans {
 public:
  // The mesh has to outlive it.
  explicit SpreadFans(const TriangleMesh& mesh);

  // False: not known. Safe for several threads.
  [[nodiscard]] bool holds(int vertex) const;

 private:
  const TriangleMesh& mesh_;
  mutable std::vector<char> told_;  // of each vertex; empty: of none of them it holds
};

}  // namespace hotblade::surface
