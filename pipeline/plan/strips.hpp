// The strips stage: chains split along their ribs and along the sweep until one elastica serves each rib
// piece, a blade of the list can be extended from it, and the block fits the stock.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/plan/joint_fit.hpp"
#include "pipeline/plan/rib_fit.hpp"
#include "pipeline/plan/seams.hpp"
#include "pipeline/program.hpp"

namespace hotblade::pipeline {

// What of its ribs a strip forms at a place of the sweep, by share of their length; the rest is waste.
struct FormedPart {
  double offset_mm = 0;
  DesignPart part;
};

// One strip before motion: ribs in common axes, the block, and the blade that cuts it.
struct StripPlan : RibAxes {
  std::string id;
  std::vector<RibFit> ribs;
  std::vector<FormedPart> formed;  // of ribs that go on past the design's border: by sections, ascending
  double blade_length_mm = 0;
  double share_a = 0.5;  // share of the extension that lies before the rib's start, on clamp A's side
  Stock stock;
  Pose design_to_cell;
  JointFitReport joint;  // the ribs solved together, before and after
  // The same strip with each rib on its own best fit, where the ribs were solved together.
  std::shared_ptr<const StripPlan> separate;
  SeamFacts seam_before;  // to the strip before, along the ribs; zeros where there is none
  double smallest_margin = 0, largest_curvature_per_mm = 0, smallest_clearance_mm = 0;

  // Between sections no less than what the ones around it form, and never nothing.
  [[nodiscard]] DesignPart formed_at(double offset_mm) const;

  // Where the blade's plane is on its way through the block and out of it: planes of a fan go on straight,
  // along their normals, soon before the first and behind the last rib.
  [[nodiscard]] Frame swept_plane(double offset_mm) const;
};

// A run of a chain's ribs that was laid out on its own.
struct LaidOutRun {
  std::size_t chain = 0, first = 0, last = 0;  // its ribs, both included; neighbouring runs share one
  std::size_t strips = 0;                      // 0: refused
};

struct StripLayout {
  std::vector<StripPlan> strips;
  std::vector<LaidOutRun> runs;  // in the order of their strips
  std::vector<Refusal> refusals;
  std::vector<std::string> warnings;
};

// Ribs stand on as many of the sections as keep the surface between them near the design. They are split at
// shares of arc length common to all ribs of a run of sections: the fewest strips, and of those the lines
// with the smallest deviation (plan/split.hpp). Strips side by side share end points and tangents where
// their deviations allow it (plan/seams.hpp). Runs are laid out on all cores allowed; the result is the same.
// `most_more` is how many strips a run may take beyond its least, and a fan's chain in runs: what needs more
// is refused, as with fit.max_splits.
[[nodiscard]] StripLayout lay_out_strips(const TargetReport& targets, const Settings& settings,
                                         std::size_t most_more = 1000);

// The runs that a layout of these targets has at the least, with `strips` 0: exactly these where planes are
// parallel; a fan may be cut into more.
[[nodiscard]] std::vector<LaidOutRun> least_runs(const TargetReport& targets, const Settings& settings);

// Strips that a run needs for the length of its longest rib alone: no layout of it has fewer.
[[nodiscard]] std::size_t least_strips(const ChainTarget& chain, const LaidOutRun& run,
                                       const Settings& settings);

// The strip cut by a shorter blade than its own: the calmest fits that one serves, which are less calm then
// but held more firmly. Nothing where no shorter blade serves. The strip's joint solution is given up.
[[nodiscard]] std::optional<StripPlan> with_shorter_blade(const StripPlan& strip, const Settings& settings);

// The blade of a rib: its elastica extended along itself to the strip's blade length.
[[nodiscard]] elastica::Elastica extended(const elastica::Elastica& rib, double blade_length_mm,
                                          double share_a);

}  // namespace hotblade::pipeline
