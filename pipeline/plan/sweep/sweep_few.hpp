// A few of a dense design's points, for first looks at it.
#pragma once

#include <memory>

#include "pipeline/plan/sweep/sweep_sections.hpp"

namespace hotblade::pipeline {

// Returns a surface with one of the points in each cell of a grid that moves and turns with the design's
// mesh: one at which the border turns before others of the border, before the nearest to the cell's middle.
// Its triangles, border and corners are those that are left of the surface's; of a corner less than a cell
// may be cut off. None where that saves little.
[[nodiscard]] std::shared_ptr<const WasteSurface> few_of(const WasteSurface& surface,
                                                         const surface::TriangleMesh& mesh, double cell_mm);

// How wide a cell may be for a blade: chords of arcs of its smallest radius over it are off by a tenth of
// the tolerance.
[[nodiscard]] double cell_for(double least_radius_mm, double tolerance_mm);

}  // namespace hotblade::pipeline
