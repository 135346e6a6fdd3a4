// The ghosts of the moving blade: its ends outside the foam, at even steps through the cut.
#pragma once

#include "pipeline/preview/scene.hpp"

namespace hotblade::pipeline::preview {

// Returns what can be told apart in a picture of a program, mm, and no finer than the kept surface is worth.
[[nodiscard]] double seen_mm(const Program& program);

// The curve in a frame's plane as points in space, no more than `step_mm` apart: 9 at least, so that no bend
// is lost, and 161 at most, which a step of 0 gives.
[[nodiscard]] Polyline line_of(const Frame& frame, const elastica::Elastica& curve, double step_mm = 0);

// Ends of the blade at even steps of its middle through the cut, with their clamps.
struct Ghosts {
  std::vector<Polyline> blades;
  std::vector<std::array<int, 2>> pose_of_blade;  // strip and pose by index
  std::vector<Pose> clamps_a, clamps_b;
  std::string note;       // "blade every 50 mm"
  bool left_out = false;  // is an end not shown because it lies over another strip?
};

// The ghosts of a program. Within the foam the cut surface shows where the blade was. An end that lies over
// another strip than its own is left out: every strip has its own block on the table, so the neighbour is
// not there when the blade passes. Without a step there are eight a strip; a step that would give thousands
// is widened, and the note says to what.
[[nodiscard]] Ghosts ghosts_of(const CutSurface& cut, const Program& program, std::optional<double> step_mm);

}  // namespace hotblade::pipeline::preview
