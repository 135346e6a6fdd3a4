// Seams: where strips that lie side by side along their ribs meet. Both sides of a seam are fitted through
// the same end points and tangents, as far as their deviation allows, so that the cut surface goes on without
// step or kink.
#pragma once

#include <vector>

#include "pipeline/plan/ribs/rib_fit.hpp"

namespace hotblade::pipeline {

// Clamps the ribs of neighbouring pieces (in order along the ribs, the same ribs in each) at the mean of
// their end states, and fits them again. A seam is given up, and its ends stay free, where a piece on either
// side would deviate by more than `allowed_mm`.
void join_pieces(std::vector<std::vector<RibFit>>& pieces, double allowed_mm);

// What is left between the ribs' elasticas: largest over all ribs that both sides have and where there is
// design at the seam.
struct SeamFacts {
  double gap_mm = 0, kink_deg = 0;
};
[[nodiscard]] SeamFacts measure_seam(const std::vector<RibFit>& before, const std::vector<RibFit>& after);

}  // namespace hotblade::pipeline
