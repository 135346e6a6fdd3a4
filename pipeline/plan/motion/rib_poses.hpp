// The blade of a strip at its ribs, before the strip has a motion.
#pragma once

#include <vector>

#include "pipeline/plan/ribs/strip_plan.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// Returns the blade with its clamps at the ribs and at quarters of the gaps between them, in order.
[[nodiscard]] std::vector<BladePose> rib_poses(const StripPlan& strip, const MachineSettings& machine);

// Returns the same of the two shapes that the cut begins and ends with, past the end ribs.
[[nodiscard]] std::vector<BladePose> end_poses(const StripPlan& strip, const MachineSettings& machine);

}  // namespace hotblade::pipeline
