// What the facets of a coarse mesh leave for a smooth cut: one that runs on evenly through a facet's corners
// rises above its edges and its middle.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "pipeline/plan/sweep/sweep_layout.hpp"

namespace hotblade::pipeline {

struct FacetRise {
  double off_mm = 0;    // what a surface that is smooth across the facets is off by at half of their area
  double facet_mm = 0;  // root of twice the area of the facet that is told of
};

// Returns it of a part: half of what the quadratic surface through a facet's corners, square to their
// normals, rises above it. A cut that bends at the edges of facets may be nearer. Zeros where the part has no
// facet.
[[nodiscard]] FacetRise smooth_over_facets(const SweepPart& part);

// Returns, of the parts of a layout that have a fit and over whose facets such a surface is off by more than
// the tolerance, the numbers of those that leave the most, at most so many.
[[nodiscard]] std::vector<std::pair<std::size_t, FacetRise>> coarsest(const Layout& layout,
                                                                      double tolerance_mm, std::size_t most);

}  // namespace hotblade::pipeline
