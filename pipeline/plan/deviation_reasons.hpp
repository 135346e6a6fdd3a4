// Why strips are farther off than the tolerance, as far as it can be told.
#pragma once

#include "pipeline/plan/plan.hpp"
#include "pipeline/settings/settings.hpp"
#include "pipeline/verify/refusal.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// Returns the refusal of the strip whose bound is the largest: the bound, the place where the strip itself
// was measured to deviate the most, with the rib nearest to it where the result has its program's strips,
// and what was measured there where that is far less.
[[nodiscard]] Refusal deviation_refusal(const PlanResult& result, double tolerance_mm);

// Adds to the first refusals for the deviation, which a report begins with, how far a blade follows the
// design about the place that they name, or that nothing is proved of it and after how many tries; and the
// nearest rib to those that were found before their strips' ribs were at hand.
void explain_deviations(const surface::DesignSurface& design, const Settings& settings, PlanResult& result);

}  // namespace hotblade::pipeline
