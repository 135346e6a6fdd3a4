// What is written over a picture: caption, keys and the scale of colours; in the window time, card and help.
#pragma once

#include "pipeline/preview/drawing/canvas.hpp"
#include "pipeline/preview/view_model.hpp"
#include "pipeline/verify/verdict.hpp"

namespace hotblade::pipeline::preview {

// A line of the key, whose swatch is a line or an area.
struct KeyLine {
  Rgb color;
  std::string words;
  double height;
  Layer layer;
};

struct Overlay {
  std::string title, verdict;
  VerdictColor verdict_color = VerdictColor::kRed;
  std::vector<std::string> caption;
  std::vector<KeyLine> keys;
  std::optional<ColorScale> scale;
  std::vector<std::string> strip_names;  // named with their colours where there is no scale
};

[[nodiscard]] Overlay overlay_of(const Scene& scene);

// Draws the overlay on the canvas; returns the height below which the left column is free, in the canvas's
// pixels.
double draw_overlay(Canvas& canvas, const Overlay& overlay, PictureSize size);

// Draws a card in the left column, below `top`.
void draw_card(Canvas& canvas, const Card& card, double top);

// Draws the time bar along the lower edge.
void draw_time_bar(Canvas& canvas, const ViewModel& model, const ViewState& state, PictureSize size);

// The share of the time (0 to 1) that a pixel of the picture stands for, x and y from the lower left; absent
// when it is not on the bar.
[[nodiscard]] std::optional<double> time_share_at(PictureSize size, double x, double y);

// The share, from 0 to 1, for a pointer that drags the bar and may be anywhere.
[[nodiscard]] double time_share_along(PictureSize size, double x);

void draw_help(Canvas& canvas, PictureSize size);

// The pixels of the picture that are kept free of geometry, for the overlay.
struct Margins {
  double left, right, top, bottom;
};
[[nodiscard]] Margins overlay_margins(PictureSize size, bool with_time_bar);

}  // namespace hotblade::pipeline::preview
