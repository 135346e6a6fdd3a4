// Ribs that go on past the design's border, so that the ribs of a run are equally wide: with an oblique or
// round border they would shrink to nothing, and a short rib says nothing about the blade.
//
// A blade cuts right through its block; what lies past the border is waste. So a rib need not end where the
// design does: there it follows what the sections beside it do at the same place.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pipeline/plan/ribs/target.hpp"

namespace hotblade::pipeline {

// The sections with both ends moved on to a window common to all of them: the least that holds every
// section's own part, along a coordinate that is arc length in each section and the same for a point and the
// one nearest to it in the next section. `own` tells the design's part; its points stay exactly as they are.
// Past it a rib goes on from its own end in the direction that a thin plate over window and sweep has there,
// bent to the directions of all sections' own parts; by a radian at the most.
//
// Nothing where no section lacks more than three tenths of the window: such ribs speak for themselves.
// Offsets ascending, at least two sections.
[[nodiscard]] std::optional<std::vector<RibTarget>> complete_ribs(std::span<const RibTarget> sections);

// Where each section begins on that coordinate, mm; 0 for the longest.
[[nodiscard]] std::vector<double> aligned_starts(std::span<const RibTarget> sections);

}  // namespace hotblade::pipeline
