// Which way the rib planes face: candidates along the body's and the cell's axes, planned coarsely and
// ranked.
#pragma once

#include <vector>

#include "pipeline/settings.hpp"
#include "surface/design_surface.hpp"

namespace hotblade::pipeline {

struct DirectionScore {
  Eigen::Vector3d normal;
  std::size_t strips = 0;
  double covered_share = 0;  // of the design's area, seen along the planes: steep slope counts less
  double score = 0;          // strips + 100 (1 - covered); lower is better
};

// Best first. With slice.direction set that direction alone is scored.
[[nodiscard]] std::vector<DirectionScore> rank_directions(const surface::DesignSurface& design,
                                                          const Settings& settings);

}  // namespace hotblade::pipeline
