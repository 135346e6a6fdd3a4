// The colours of the cut: one value a vertex, and the scale that turns values into colours.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/preview/scene.hpp"

namespace hotblade::pipeline::preview {

struct Coloring {
  std::vector<double> values;       // a vertex; empty: coloured by strip
  std::optional<ColorScale> scale;  // absent: by strip
};

// The colours of the cut by feed in mm/s of the blade's own points between poses, curvature in per cent of
// the curvature at yield, stability margin of the pose, or signed deviation (mm), which the surface must
// have.
[[nodiscard]] Coloring coloring_of(Color color, const Program& program, const CutSurface& surface);

}  // namespace hotblade::pipeline::preview
