// Why strips are farther off than the tolerance, as far as it can be told.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/settings/settings.hpp"
#include "pipeline/verify/refusal.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// Adds to the first refusals for the deviation, which a report begins with, how far a blade follows the
// design about the place that they name, or that nothing is proved of it and after how many tries.
void explain_deviations(const surface::DesignSurface& design, const Settings& settings, std::size_t tries,
                        std::vector<Refusal>& refusals);

}  // namespace hotblade::pipeline
