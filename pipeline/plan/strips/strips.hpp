// The strips stage: chains split along their ribs and along the sweep until one elastica serves each rib
// piece, a blade of the list can be extended from it, and the block fits the stock.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "pipeline/plan/ribs/strip_plan.hpp"

namespace hotblade::pipeline {

// A run of a chain's ribs that was laid out on its own.
struct LaidOutRun {
  std::size_t chain = 0, first = 0, last = 0;  // its ribs, both included; neighbouring runs share one
  std::size_t strips = 0;                      // 0: refused
};

// The strips of a design before motion.
struct StripLayout {
  std::vector<StripPlan> strips;
  std::vector<LaidOutRun> runs;  // in the order of their strips
  std::vector<Refusal> refusals;
  std::vector<std::string> warnings;
};

// More strips than any design takes.
inline constexpr std::size_t kMostMoreStrips = 1000;

// Told before every try of a strip, from all threads; what it throws ends the layout at once.
using WatchTries = std::function<void()>;

// Returns the strips of the targets. Ribs stand on as many of the sections as keep the surface between them
// near the design. They are split at shares of arc length common to all ribs of a run of sections: the fewest
// strips, and of those the lines with the smallest deviation (pipeline/plan/strips/split.hpp). Strips side by
// side share end points and tangents where their deviations allow it (pipeline/plan/ribs/seams.hpp). Runs are
// laid out on all cores allowed; the result is the same. `most_more` is how many strips a run may take beyond
// its least, and a fan's chain in runs: what needs more is refused, as with fit.max_splits.
[[nodiscard]] StripLayout lay_out_strips(
    const TargetReport& targets, const Settings& settings, std::size_t most_more = kMostMoreStrips,
    const WatchTries& watch = [] {});

// Returns the runs that a layout of these targets has at the least, with `strips` 0: exactly these where
// planes are parallel; a fan may be cut into more.
[[nodiscard]] std::vector<LaidOutRun> least_runs(const TargetReport& targets, const Settings& settings);

// Returns the number of strips that a run needs for the length of its longest rib alone: no layout of it has
// fewer.
[[nodiscard]] std::size_t least_strips(const ChainTarget& chain, const LaidOutRun& run,
                                       const Settings& settings);

// Returns the strip cut by a shorter blade than its own: the calmest fits that one serves, which are less
// calm then but held more firmly. Returns nothing where no shorter blade serves. The strip's joint solution
// is given up.
[[nodiscard]] std::optional<StripPlan> with_shorter_blade(const StripPlan& strip, const Settings& settings);

}  // namespace hotblade::pipeline
