// A run of sections on its way to strips: ribs on some of the sections, split lines common to all of them.
#pragma once

#include <span>

#include "pipeline/plan/strips/strips.hpp"

namespace hotblade::pipeline {

// Ribs of sections of unequal width are completed to a common one (pipeline/plan/ribs/complete.hpp), unless
// fewer strips, or as many with fewer ribs, cut the sections as they are.
//
// Returns the strips of these sections of the chain, at most `most_more` more than they need at the least,
// without names; or one refusal. `sections`: at least two, offsets ascending.
[[nodiscard]] StripLayout lay_out_run(const ChainTarget& chain, std::span<const RibTarget> sections,
                                      const Settings& settings, std::size_t most_more,
                                      const WatchTries& watch);

}  // namespace hotblade::pipeline
