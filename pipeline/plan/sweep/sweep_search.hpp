// Swept plans of a design: strips that are one family of elastica each, their planes parallel or a fan.
//
// Directions are ranked by cheap fits, which cost some milliseconds each; the best are fitted closely and,
// where they do not serve, their planes turned as Gauss and Newton would. A design too large for one block,
// or one that a single family does not follow, is split along the sweep or along the ribs into the fewest
// even parts that do. What of a plan still fails, parts that no block, blade or family serves and strips that
// were verified and found wanting, is split again at its place, and only that. Of a design of many parts each
// strip is looked at by itself first: what fails so costs no fit of all together, and no measurement of all.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "pipeline/plan/sweep/sweep_layout.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// How a layout came about.
enum class SweepWay {
  kEven,      // even parts of the whole
  kRows,      // rows of blocks
  kSplit,     // what failed of the try before, split at its place
  kCalmer,    // what failed of the try before, fitted more calmly
  kTurned,    // the planes of the try before, turned until its fit was nearer
  kMet,       // the strips of the try before, fitted together by what was found of them
  kUnsteady,  // what failed of the try before, with the blades that its strips had before they were steadied
  kFaces,     // smooth faces that meet in creases, the plans of all together
  kParted,    // the best planes split where no strip serves, in the fewest parts
};
[[nodiscard]] const char* name(SweepWay way);

// The settings that a part was fitted with.
struct SweptFit {
  int coefficients = 0;  // of each function of the sweep
  double calm = 0;       // SweepFitOptions
  double blade_length_mm = 0, fit_mm = 0;
  double clamps_mm = 0;  // what the clamps' errors move its own strip by; 0: it has none
  // Of a strip whose blade was made steadier against them, what it was before.
  struct Before {
    double blade_length_mm = 0, fit_mm = 0, clamps_mm = 0;
  };
  std::optional<Before> before{};
};

// A layout with its parts fitted closely.
struct SweptPlan {
  SweepWay way = SweepWay::kEven;
  std::size_t parts = 0;       // of the whole layout, of which those below may be some
  std::vector<SweptFit> fits;  // of the parts in their order, those that are refused among them
  surface::PlaneFamily planes;
  double deviation_mm = 0;        // largest of the fits, at their samples
  double sag_mm = 0;              // what weight moves the cut, at most, as the fits tell
  std::vector<StripPlan> strips;  // named S001 on; those that are refused are left out
  std::vector<Refusal> refusals;  // of parts that have no strip, by their places
};

// What came of a plan that was looked at in full.
struct SweepVerdict {
  bool taken = false;
  std::vector<bool> failed = {};     // of its strips; empty: none is to blame
  std::vector<bool> too_far = {};    // of those, the ones that leave the design too far; as many, or none
  std::vector<bool> misshapen = {};  // of those, the ones that their blade's shape refuses; as many, or none
  std::vector<double> deviation_mm = {};  // of its strips, with what of their sag is not known; or none
};
using JudgeSweep = std::function<SweepVerdict(const SweptPlan&)>;

// Who looks at plans.
struct SweepJudges {
  JudgeSweep together;  // at all strips of a plan, fitted together
  // At some strips of a plan of many, each by its own fit or as it meets the others, and with the parts that
  // have none; those that it takes go on.
  JudgeSweep alone;
  // Is told of the plan that a search of many parts ends with where some fail by themselves.
  std::function<void(const SweptPlan&)> given_up = [](const SweptPlan&) {};
};

// What the blades of a plan's strips melt by the speeds that they would have; for each strip in its order,
// none where its blade does not move.
using BandsOfSweep = std::function<std::vector<std::shared_ptr<const SweptBands>>(const SweptPlan&)>;

// Hands plans over until one is taken together, or all are left: fewer parts first, then smaller deviations.
// Those with parts that have no strip are handed over with the reasons, and are not to be taken. Returns the
// planes that were ranked on the way. The same input gives the same plans, whatever the number of threads.
// Throws surface::FanError where `slice.fan_axis` does not go with the design. With `bands`, strips are
// fitted anew until the speeds that they lead to melt what they were offset by, before they are handed over.
// No layout has more than `most_parts`.
std::vector<PlanesTried> search_sweeps(
    const surface::DesignSurface& design, const Settings& settings, const SweepJudges& judges,
    const WatchSweeps& watch = [] {}, const BandsOfSweep& bands = nullptr,
    std::size_t most_parts = kMostStrips);

}  // namespace hotblade::pipeline
