// What the errors of the clamps move a strip's blade by, before the strip has a motion.
#pragma once

#include "pipeline/plan/ribs/strip_plan.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// Returns what the clamps' errors (settings.machine) move the part in foam by, at the ribs, as the budget's
// line does (verify/clamp_error.hpp), and at quarters of the gaps between them: the largest. A blade that is
// nearly straight is taken to keep its side while its slack is more than the clamps err by.
[[nodiscard]] double rib_clamp_error_mm(const StripPlan& strip, const MachineSettings& machine);

}  // namespace hotblade::pipeline
