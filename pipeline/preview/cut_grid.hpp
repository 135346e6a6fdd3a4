// The surface swept by the blade's centre over the foam intervals, as a grid: one row a pose, columns by arc
// length.
#pragma once

#include <vector>

#include "pipeline/preview/scene.hpp"

namespace hotblade::pipeline::preview {

struct CutGrid {
  CutSurface surface;                                       // values left empty
  std::vector<double> curvature_per_mm, margin, feed_mm_s;  // a vertex
};

// Over all strips of the program. Rows closer than a few millimetres are thinned out.
[[nodiscard]] CutGrid cut_grid(const Program& program);

}  // namespace hotblade::pipeline::preview
