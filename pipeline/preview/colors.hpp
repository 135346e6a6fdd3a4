// The colours of pictures, and of values on a scale.
#pragma once

#include <array>

#include "pipeline/preview/scene.hpp"

namespace hotblade::pipeline::preview {

using Rgb = std::array<double, 3>;  // 0 to 1

// Light enough for print, dark enough that white surfaces stand out.
constexpr Rgb kBackground{0.925, 0.935, 0.945};
constexpr Rgb kInk{0.13, 0.15, 0.18};
constexpr Rgb kGoodColor{0.07, 0.45, 0.22};
constexpr Rgb kWarningColor{0.63, 0.35, 0.0};
constexpr Rgb kBadColor{0.75, 0.08, 0.08};
constexpr Rgb kDesignColor{0.78, 0.79, 0.80};
constexpr Rgb kRibColor{0.42, 0.45, 0.50};
constexpr Rgb kBladeColor{0.20, 0.42, 0.62};
constexpr Rgb kBladeNowColor{0.85, 0.10, 0.10};
constexpr Rgb kClampAColor{0.10, 0.55, 0.30};
constexpr Rgb kClampBColor{0.85, 0.50, 0.05};
constexpr Rgb kStockColor{0.55, 0.57, 0.60};
constexpr Rgb kPathColor{0.55, 0.30, 0.65};
constexpr Rgb kWorstColor{0.80, 0.10, 0.62};  // no colour of a map
constexpr Rgb kFirstArmColor{0.86, 0.62, 0.36};
constexpr Rgb kSecondArmColor{0.52, 0.62, 0.74};
constexpr Rgb kToolColor{0.30, 0.32, 0.36};
constexpr Rgb kStandingColor{0.80, 0.79, 0.76};
constexpr Rgb kSelectedColor{0.95, 0.10, 0.55};

// The colour of a value on a scale; values outside take the colour of its end.
[[nodiscard]] Rgb color_at(const ColorScale& scale, double value);
// The colour of the strip with this index; colours repeat after eight.
[[nodiscard]] Rgb strip_color(int strip);

}  // namespace hotblade::pipeline::preview
