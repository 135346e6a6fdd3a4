// The smooth faces of a design as designs of their own, and their plans as one.
#pragma once

#include "pipeline/plan/sweep/sweep_search.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/triangle_mesh.hpp"

namespace hotblade::pipeline {

// Returns a face of a design, in its units.
[[nodiscard]] surface::DesignSurface face_of(const surface::DesignSurface& design,
                                             const surface::TriangleMesh& mesh);

// Puts a face's plan behind those of the faces before, its parts named on from theirs.
void append(SweptPlan& whole, SweptPlan face);

}  // namespace hotblade::pipeline
