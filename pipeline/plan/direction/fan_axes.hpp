// Lines that rib planes may turn about, found from the design itself: where the planes of two of its border's
// sides meet, axes of circular borders, and the axis of the surface of revolution that fits it best.
#pragma once

#include <vector>

#include "pipeline/plan/direction/body_axes.hpp"
#include "pipeline/plan/direction/border_runs.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::pipeline {

// Returns axes as seen from the body: the point is the foot of the body's centre, the direction a unit vector
// whose sense is that of with_sense; they move and turn with the design. Borders first, as they say it most
// exactly. No two agree to 2 degrees and 2 % of the body's size. Whether planes can turn about them is not
// asked here. `sides` are the border's (long_sides).
[[nodiscard]] std::vector<surface::FanAxis> fan_axes(const surface::TriangleMesh& mesh, const BodyAxes& body,
                                                     const std::vector<BorderRun>& sides);

// Returns the axes of the rotations under which the surface moves least along its normals: eigenvectors of
// the normals' line complex (Pottmann, Wallner 2001, "Computational Line Geometry", 4.1 and 6.3; a pitch is
// left out). At most three, best first; those that move it by more than a quarter of the way its points go
// are none.
[[nodiscard]] std::vector<surface::FanAxis> revolution_axes(const surface::TriangleMesh& mesh,
                                                            const BodyAxes& body);

}  // namespace hotblade::pipeline
