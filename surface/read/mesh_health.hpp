// What a mesh measures, for its health report.
#pragma once

#include "surface/read/design_surface.hpp"

namespace hotblade::surface {

// Fills in counts, area and bounding box, and the border's figures from the half-edges. Those stay 0 for a
// mesh with blockers; one that OpenMesh cannot hold whole gets a blocker here. The mesh must have triangles.
void measure_mesh(const TriangleMesh& mesh, Health& health);

}  // namespace hotblade::surface
