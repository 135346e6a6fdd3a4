#include "pipeline/preview/drawing/overlay.hpp"
#include "pipeline/preview/picture_texts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hotblade::pipeline::preview {
namespace {

// In the canvas's pixels, of a picture of 1280 x 720.
constexpr double kEdge = 24, kLeftColumn = 290, kRightColumn = 196, kTimeBar = 76;
constexpr std::size_t kColumnLetters = 34;  // that fit left of the geometry

const Rgb& color_of(VerdictColor verdict) {
  if (verdict == VerdictColor::kRed) return kBadColor;
  return verdict == VerdictColor::kAmber ? kWarningColor : kGoodColor;
}

double draw_caption(Canvas& canvas, const Overlay& overlay, double top) {
  double y = top - 30;
  canvas.text(kEdge, y, overlay.title, 22, true);
  y -= 32;
  if (!overlay.verdict.empty()) {
    canvas.text(kEdge, y, canvas.said(overlay.verdict), 16, true, Align::kLeft,
                color_of(overlay.verdict_color));
    y -= 28;
  }
  for (const std::string& line : overlay.caption) {
    for (const std::string& part : wrapped(canvas.said(line), kColumnLetters)) {
      canvas.text(kEdge, y, part, 15);
      y -= 22;
    }
    y -= 4;
  }
  return y;
}

void draw_keys(Canvas& canvas, const std::vector<KeyLine>& keys) {
  double y = 26 + 24 * (static_cast<double>(keys.size()) - 1);
  for (const KeyLine& key : keys) {
    canvas.rectangle(kEdge, y - key.height / 2, 24, key.height, key.color);
    canvas.text(58, y, canvas.said(key.words), 15);
    y -= 24;
  }
}

// The strips' colours, where a scale would be.
void draw_strips(Canvas& canvas, const std::vector<std::string>& names, PictureSize size) {
  constexpr std::size_t kMost = 16;
  const double scale = overlay_scale(size);
  const std::size_t shown = std::min(names.size(), kMost);
  const double lines = static_cast<double>(shown + (shown < names.size() ? 1 : 0));
  const double right = size.width / scale - 28, x = right - 160;
  double y = size.height / scale / 2 + 12 * lines;
  for (std::size_t i = 0; i < shown; ++i) {
    canvas.rectangle(x, y - 6, 24, 12, strip_color(static_cast<int>(i)));
    canvas.text(x + 32, y, canvas.said(names[i]), 14);
    y -= 24;
  }
  if (shown < names.size())
    canvas.text(x, y, canvas.said(text_of(PictureText::kColoursRepeat, names.size() - shown)), 13);
}

struct Bar {
  double x, width, bottom, height;
  ColorScale scale;
  // Of the bar's half, what lies within the tolerance, where it would hardly be seen on a wide scale.
  static constexpr double kInside = 0.3;
  [[nodiscard]] bool parted() const { return scale.tolerance && *scale.tolerance < kInside * scale.high; }
  [[nodiscard]] double place(double value) const {
    if (!parted()) return bottom + (value - scale.low) / (scale.high - scale.low) * height;
    const double size = std::abs(value), tolerance = *scale.tolerance;
    const double share = size <= tolerance
                             ? kInside * size / tolerance
                             : kInside + (1 - kInside) * (size - tolerance) / (scale.high - tolerance);
    return bottom + 0.5 * height * (1 + std::copysign(share, value));
  }
  // The value at a share of the height, from 0 to 1.
  [[nodiscard]] double value(double share) const {
    if (!parted()) return scale.low + share * (scale.high - scale.low);
    const double half = std::abs(2 * share - 1), tolerance = *scale.tolerance;
    const double size = half <= kInside
                            ? half / kInside * tolerance
                            : tolerance + (half - kInside) / (1 - kInside) * (scale.high - tolerance);
    return std::copysign(size, 2 * share - 1);
  }
};

void draw_tick(Canvas& canvas, const Bar& bar, double value, const std::string& words, bool bold) {
  const double y = bar.place(value);
  canvas.rectangle(bar.x - 6, y - 0.75, 6, 1.5, kInk);
  canvas.text(bar.x - 12, y, words, 14, bold, Align::kRight);
}

void draw_bar_body(Canvas& canvas, const Bar& bar) {
  constexpr int kSteps = 190;
  const auto& [x, width, bottom, height, scale] = bar;
  for (int step = 0; step < kSteps; ++step) {
    canvas.rectangle(x, bottom + step * height / kSteps, width, height / kSteps + 0.01,
                     color_at(scale, bar.value((step + 0.5) / kSteps)));
  }
  canvas.rectangle(x - 1, bottom - 1, width + 2, 1, kInk);
  canvas.rectangle(x - 1, bottom + height, width + 2, 1, kInk);
  canvas.rectangle(x - 1, bottom, 1, height, kInk);
  canvas.rectangle(x + width, bottom, 1, height, kInk);
}

void draw_diverging_marks(Canvas& canvas, const Bar& bar, double right) {
  const double tolerance = *bar.scale.tolerance, top = bar.bottom + bar.height;
  canvas.text(right, top + 60, canvas.said(text_of(PictureText::kFoamLeft)), 13, false, Align::kRight);
  draw_tick(canvas, bar, bar.scale.high, fmt::format("+{:g}", bar.scale.high), false);
  draw_tick(canvas, bar, tolerance, canvas.said(text_of(PictureText::kAboveTolerance, tolerance)), true);
  draw_tick(canvas, bar, 0, "0", false);
  draw_tick(canvas, bar, -tolerance, canvas.said(text_of(PictureText::kBelowTolerance, tolerance)), true);
  draw_tick(canvas, bar, bar.scale.low, fmt::format("{:g}", bar.scale.low), false);
  if (bar.parted()) {
    const double middle = 0.5 * (tolerance + bar.scale.high);
    draw_tick(canvas, bar, middle, fmt::format("+{:.3g}", middle), false);
    draw_tick(canvas, bar, -middle, fmt::format("-{:.3g}", middle), false);
  }
  canvas.text(right, bar.bottom - 30, canvas.said(text_of(PictureText::kTooDeep)), 13, false, Align::kRight);
}

void draw_sequential_marks(Canvas& canvas, const Bar& bar) {
  constexpr double kApart = 16;  // or the words of two marks meet
  const ColorScale& scale = bar.scale;
  const auto clear_of_limit = [&](double value) {
    return !scale.limit || std::abs(bar.place(value) - bar.place(*scale.limit)) > kApart;
  };
  const long marks = std::lround((scale.high - scale.low) / scale.step);
  for (long mark = 0; mark <= marks; ++mark) {
    // Rounded to the step's digits, so that zero is no 1e-17.
    const double value = std::round(scale.low / scale.step + static_cast<double>(mark)) * scale.step;
    if (clear_of_limit(value)) draw_tick(canvas, bar, value, fmt::format("{:.4g}", value), false);
  }
  if (!scale.limit) return;
  const std::string words = canvas.said(text_of(PictureText::kAllowed, *scale.limit));
  if (*scale.limit <= scale.high) {
    draw_tick(canvas, bar, *scale.limit, words, true);
  } else {
    canvas.text(bar.x + bar.width, bar.bottom + bar.height + 60, words, 14, false, Align::kRight);
  }
}

void draw_bar(Canvas& canvas, const ColorScale& scale, PictureSize size) {
  const double pixels = overlay_scale(size);
  const double width = 22, right = size.width / pixels - 28, height = 380;
  const Bar bar{right - width, width, (size.height / pixels - height) / 2 - 10, height, scale};
  draw_bar_body(canvas, bar);
  canvas.text(right, bar.bottom + height + 36, canvas.said(scale.title), 16, true, Align::kRight);
  if (scale.tolerance) {
    draw_diverging_marks(canvas, bar, right);
  } else {
    draw_sequential_marks(canvas, bar);
  }
}

}  // namespace

Overlay overlay_of(const Scene& scene) {
  Overlay overlay;
  overlay.title = scene.title;
  overlay.verdict = scene.verdict;
  overlay.verdict_color = scene.verdict_color;
  overlay.caption = scene.caption;
  overlay.scale = scene.scale;
  if (!scene.cut.triangles.empty()) overlay.strip_names = scene.strip_names;
  auto& keys = overlay.keys;
  if (!scene.design.triangles().empty()) {
    const std::string words = scene.cut.triangles.empty() ? "design" : text_of(PictureText::kDesignNotCut);
    keys.push_back({kDesignColor, words, 12, Layer::kDesign});
  }
  if (!scene.ribs.empty()) keys.push_back({kRibColor, text_of(PictureText::kPlannedRibs), 3, Layer::kRibs});
  if (!scene.blades.empty()) keys.push_back({kBladeColor, scene.blade_note, 3, Layer::kGhosts});
  if (scene.blade_now) keys.push_back({kBladeNowColor, scene.blade_note, 4, Layer::kBlade});
  if (!scene.clamps_a.empty()) {
    const Layer layer = scene.blade_now ? Layer::kBlade : Layer::kGhosts;
    keys.push_back({kClampAColor, "clamp A", 12, layer});
    keys.push_back({kClampBColor, "clamp B", 12, layer});
  }
  if (scene.worst) keys.push_back({kWorstColor, scene.worst->words, 3, Layer::kLegend});
  if (!scene.blocks.empty())
    keys.push_back({kStockColor, text_of(PictureText::kFoamBlock), 3, Layer::kBlocks});
  for (const CellPartKind kind : {CellPartKind::kFirstArm, CellPartKind::kSecondArm}) {
    const auto part =
        std::find_if(scene.cell.begin(), scene.cell.end(), [&](const CellPart& p) { return p.kind == kind; });
    if (part == scene.cell.end()) continue;
    keys.push_back({kind == CellPartKind::kFirstArm ? kFirstArmColor : kSecondArmColor,
                    kind == CellPartKind::kFirstArm ? "first arm" : "second arm", 12, Layer::kArms});
  }
  return overlay;
}

Margins overlay_margins(PictureSize size, bool with_time_bar) {
  const double scale = overlay_scale(size);
  return {kLeftColumn * scale, kRightColumn * scale, kEdge * scale,
          (with_time_bar ? kTimeBar : kEdge) * scale};
}

double draw_overlay(Canvas& canvas, const Overlay& overlay, PictureSize size) {
  const double top = draw_caption(canvas, overlay, size.height / overlay_scale(size));
  draw_keys(canvas, overlay.keys);
  if (overlay.scale) {
    draw_bar(canvas, *overlay.scale, size);
  } else {
    draw_strips(canvas, overlay.strip_names, size);
  }
  return top;
}

}  // namespace hotblade::pipeline::preview
