// The health figures that need a halfedge mesh, measured in OpenMesh, and the check that OpenMesh took the
// mesh whole.
#pragma once

#include "surface/read/mesh_repair.hpp"

namespace hotblade::surface {

// Fills in counts, borders, area and bounding box. Builds an OpenMesh mesh unless the mesh has blockers
// already, and adds a blocker when OpenMesh ends up with other counts than the checked data. Border figures
// of a blocked mesh stay 0.
void measure_mesh(const RepairedMesh& repaired, Health& health);

}  // namespace hotblade::surface
