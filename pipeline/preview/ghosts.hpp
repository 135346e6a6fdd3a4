// Where the moving blade is drawn: its ends outside the foam, at even steps through the cut.
#pragma once

#include "pipeline/preview/scene.hpp"

namespace hotblade::pipeline::preview {

// The curve as points in space.
[[nodiscard]] Polyline line_of(const Frame& frame, const elastica::Elastica& curve);

// Adds blades, clamps and the note on them. Within the foam the cut surface shows where the blade was. An end
// that lies over another strip than its own is left out, and the caption says so: every strip has its own
// block on the table, so the neighbour is not there when the blade passes. `scene.cut` has to be filled.
void add_ghosts(Scene& scene, const Program& program);

}  // namespace hotblade::pipeline::preview
