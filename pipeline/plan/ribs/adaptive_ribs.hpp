// On which of the sections a strip has ribs: as few as keep the surface between them near the design.
#pragma once

#include <span>
#include <vector>

#include "pipeline/plan/ribs/rib_fit.hpp"

namespace hotblade::pipeline {

// Returns the ribs to begin with, as indices into ascending offsets: both ends and the sections next to even
// places between them, five in all where there are as many. Throws std::logic_error for fewer than two
// sections.
[[nodiscard]] std::vector<std::size_t> first_ribs(std::span<const RibTarget> sections);

// Returns the distance below which ribs do not come: a share of the sections' mean distance.
[[nodiscard]] double least_rib_gap_mm(std::span<const RibTarget> sections);

// One strip's ribs: the share of the sections that it cuts and its fits, in the order of `ribs`.
struct FittedShare {
  double u0 = 0, u1 = 1;
  std::span<const RibFit> fits;
};

// Returns the sections to add to `ribs`: in each gap between ribs the one nearest to its middle of those
// where a strip, interpolated between its ribs, is farther from the section than from its worst rib, by more
// than `limit_mm`. Sections closer to a rib than a share of the mean distance are passed over: two ribs that
// close would make the interpolation swing.
[[nodiscard]] std::vector<std::size_t> ribs_to_add(std::span<const RibTarget> sections,
                                                   std::span<const std::size_t> ribs,
                                                   std::span<const FittedShare> strips, double limit_mm);

}  // namespace hotblade::pipeline
