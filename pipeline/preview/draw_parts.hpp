// The parts of a picture: actors for the scene's geometry, camera, and the flat overlay with caption and
// keys.
#pragma once

#include <array>

#include "pipeline/preview/draw.hpp"

class vtkImageData;
class vtkRenderer;

namespace hotblade::pipeline::preview {

using Rgb = std::array<double, 3>;  // 0 to 1

// Light enough for print, dark enough that white surfaces stand out.
constexpr Rgb kBackground{0.925, 0.935, 0.945};
constexpr Rgb kInk{0.13, 0.15, 0.18};
constexpr Rgb kGoodColor{0.07, 0.45, 0.22};
constexpr Rgb kBadColor{0.75, 0.08, 0.08};
constexpr Rgb kDesignColor{0.78, 0.79, 0.80};
constexpr Rgb kRibColor{0.42, 0.45, 0.50};
constexpr Rgb kBladeColor{0.20, 0.42, 0.62};
constexpr Rgb kBladeNowColor{0.85, 0.10, 0.10};
constexpr Rgb kClampAColor{0.10, 0.55, 0.30};
constexpr Rgb kClampBColor{0.85, 0.50, 0.05};
constexpr Rgb kStockColor{0.55, 0.57, 0.60};

// Colour of a value on a scale; values outside take the colour of its end.
[[nodiscard]] Rgb color_at(const ColorScale& scale, double value);
// Colour of the strip with this index; repeats after eight.
[[nodiscard]] Rgb strip_color(int strip);

// `zoom` is how many pixels are drawn for one of the picture.
void add_actors(const Scene& scene, vtkRenderer& renderer, double zoom);
void aim_camera(const Scene& scene, vtkRenderer& renderer, PictureSize size, View view);
void add_overlay(const Scene& scene, vtkRenderer& renderer, PictureSize size, double zoom);

// The scene drawn into `image` without a display, from where `framed` fills the picture; RGB.
void draw_image(const Scene& scene, const Scene& framed, PictureSize size, View view, vtkImageData& image);

// Pixels of the picture kept free of geometry, for the overlay.
struct Margins {
  double left, right, top, bottom;
};
[[nodiscard]] Margins overlay_margins(PictureSize size);

}  // namespace hotblade::pipeline::preview
