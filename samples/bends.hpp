// Parts that turn about an axis beside them, so that one end of the blade goes nearly three times as fast as
// the other: what a band that depends on the speed is measured on.
#pragma once

#include <vector>

#include "pipeline/settings/settings.hpp"
#include "robot/blade/melt.hpp"
#include "samples/sample_surfaces.hpp"

namespace hotblade::samples {

// The axis that all of them turn about is z. Their sections through it are circular arcs, which a blade takes
// exactly: what a cut is off by is the band's. They are meshed within 0.01 mm of their formulas.
[[nodiscard]] std::vector<SampleSurface> bends();

// The settings of a bend's job: short stiff blades, which hardly sag in planes that tilt.
[[nodiscard]] pipeline::Settings bend_settings(const SampleSurface& bend);

// The foam that they are cut from: bands in mm at mm/s down to motion.min_feed_mm_s, assumed.
[[nodiscard]] robot::Melt bend_foam();

}  // namespace hotblade::samples
