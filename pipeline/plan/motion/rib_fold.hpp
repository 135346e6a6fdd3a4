// How near a strip's blade comes to snapping, before the strip has a motion.
#pragma once

#include "pipeline/plan/ribs/strip_plan.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// Returns by how many mm of the clamps' errors the blade snaps (elastica/blade/clamp_margin.hpp), at the
// ribs, at quarters of the gaps between them and where the cut begins and ends: the smallest, and no more
// than `farthest_mm`, which is positive. As in the checks of a motion, blades that are nearly straight do not
// count. How the blade is formed is not looked at.
[[nodiscard]] double rib_fold_mm(const StripPlan& strip, const MachineSettings& machine, double farthest_mm);

}  // namespace hotblade::pipeline
