// Pictures of the study of quadratic Beziers (docs/studies.md).
#pragma once

#include <string>

namespace hotblade::pipeline::study {

// The level sets of length and energy in the middle control point (the paper's figures 1 and 2).
[[nodiscard]] std::string level_set_figure();

// Curves of least length and energy tangent to a line and a circle, with the locus of the middle control
// point and the level set through it (the paper's figure 7).
[[nodiscard]] std::string tangent_figure();

}  // namespace hotblade::pipeline::study
