// A mesh with fewer points, for a first look at its shape.
#pragma once

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::pipeline {

// Returns the mesh with all its points in one cell of a grid, `cell_mm` wide, as one of them: the nearest to
// their mean. Triangles that lose a corner that way are dropped, and so are further ones of the same three
// points. Points of no triangle are left out. A mesh that is coarser stays as it is.
[[nodiscard]] surface::TriangleMesh thinned(const surface::TriangleMesh& mesh, double cell_mm);

}  // namespace hotblade::pipeline
