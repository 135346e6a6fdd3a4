// Pictures of the study of circular arcs (docs/studies.md).
#pragma once

#include <string>

#include "pipeline/study/svg_plot.hpp"

namespace hotblade::pipeline::study {

// A spiral with its bilens, biarc and triarc, and an elastica as the arcs of a coarse fit.
[[nodiscard]] std::string arc_figure();

// End points of random spirals of length 1 between Gamma1 and Gamma2 (the paper's figures 5 to 7).
[[nodiscard]] std::string reach_figure(std::uint64_t seed);

}  // namespace hotblade::pipeline::study
