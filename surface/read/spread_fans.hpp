// Finds the vertices of a mesh whose triangles lie side by side about them.
#pragma once

#include <vector>

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {

// Returns for each vertex 1 where it is proved that no two of its triangles cross: it is inside the surface,
// and seen along one of the axes its triangles turn about it once, all in one sense, so that two of them have
// in common what they have as neighbours only. That is told in numbers that rounding cannot have turned
// (Shewchuk 1997, the filter of orient2d), and holds at nearly every vertex of a smooth surface. 0: not
// known, as everywhere on a mesh that is no plain surface.
[[nodiscard]] std::vector<char> spread_fans(const TriangleMesh& mesh);

}  // namespace hotblade::surface
