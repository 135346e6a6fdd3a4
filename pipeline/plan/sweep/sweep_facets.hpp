// What the facets of a coarse mesh leave for a smooth cut: one that runs on evenly through a facet's corners
// rises above its edges and its middle.
#pragma once

#include <span>

#include "pipeline/plan/sweep/sweep_sections.hpp"

namespace hotblade::pipeline {

struct FacetRise {
  double off_mm = 0;    // what a surface that is smooth across the facets is off by at half of their area
  double facet_mm = 0;  // root of twice the area of the facet that is told of
};

// Returns it of what of a surface lies behind these seams: half of what the quadratic surface through a
// facet's corners, square to their normals, rises above it. A cut that bends at the edges of facets may be
// nearer. Zeros where there is no facet.
[[nodiscard]] FacetRise smooth_over_facets(const WasteSurface& surface, std::span<const SweepSeam> seams);

}  // namespace hotblade::pipeline
