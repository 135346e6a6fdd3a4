// Small plots of a report as SVG text: no script, no outside file, legible in print.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline/report/words.hpp"
#include "pipeline/verify/verify.hpp"

namespace hotblade::pipeline {

// The text made safe for HTML and SVG: bytes that are no UTF-8 have its mark for that in their place.
[[nodiscard]] std::string escaped(const std::string& text);

// A plot of the samples' share by deviation, with the tolerance marked; what lies beyond the last bin stands
// in a bar of its own.
[[nodiscard]] std::string histogram_svg(const DeviationHistogram& histogram, double tolerance_mm,
                                        const Words& w = Words("en"));

// A plot with one bar a line of the error budget and one for their sum, against the tolerance.
[[nodiscard]] std::string budget_svg(const std::vector<std::pair<std::string, double>>& budget_mm,
                                     double tolerance_mm, const Words& w = Words("en"));

}  // namespace hotblade::pipeline
