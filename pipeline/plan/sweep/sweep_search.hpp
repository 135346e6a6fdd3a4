// Swept plans of a design: parallel planes in many directions, each strip one family of elastica.
//
// Directions are ranked by cheap fits, which cost some milliseconds each; the best are fitted closely and
// turned a little to and fro. A design too large for one block, or one that a single family does not follow,
// is split along the sweep or along the ribs into the fewest parts that do; hard parts are narrower.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "pipeline/plan/ribs/strip_plan.hpp"
#include "pipeline/settings/settings.hpp"
#include "pipeline/verify/refusal.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// One direction with its parts fitted closely.
struct SweptPlan {
  Eigen::Vector3d normal{0, 0, 0};
  std::size_t along_sweep = 1, along_ribs = 1;  // parts
  double deviation_mm = 0;                      // largest of the fits, at their samples
  double sag_mm = 0;                            // what weight moves the cut, at most, as the fits tell
  std::vector<StripPlan> strips;                // named S001 on; empty where one is refused
  std::optional<Refusal> refusal;
};

// Whether a plan is taken, once it has been looked at in full.
using AcceptSweep = std::function<bool(const SweptPlan&)>;

// Told how far the search is, 0 to 1, before every fit of a part, from all threads; what it throws ends the
// search at once.
using WatchSweeps = std::function<void(double share)>;

// Hands plans over until one is taken, or all are left: fewer parts first, then smaller deviations. Those
// whose strips are refused are handed over with the reason. The same input gives the same plans, whatever the
// number of threads.
void search_sweeps(
    const surface::DesignSurface& design, const Settings& settings, const AcceptSweep& accept,
    const WatchSweeps& watch = [](double) {});

}  // namespace hotblade::pipeline
