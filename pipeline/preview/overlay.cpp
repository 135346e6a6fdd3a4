#include <fmt/format.h>
#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>

#include "pipeline/preview/draw_parts.hpp"

namespace hotblade::pipeline::preview {
namespace {

// Sizes below are pixels of a picture of 1280 x 720 and scale with the picture.
double overlay_scale(PictureSize size) {
  return std::min(size.width / 1280.0, size.height / 720.0);
}

enum class Align { kLeft, kCentre, kRight };

// Flat shapes and words, in pixels from the picture's lower left.
class Canvas {
 public:
  Canvas(vtkRenderer& renderer, double pixels) : renderer_(renderer), pixels_(pixels) {
    colors_->SetNumberOfComponents(3);
  }

  void rectangle(double x, double y, double width, double height, const Rgb& color) {
    const double corners[4][2] = {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
    quads_->InsertNextCell(4);
    for (const auto& corner : corners) {
      quads_->InsertCellPoint(points_->InsertNextPoint(corner[0] * pixels_, corner[1] * pixels_, 0));
    }
    unsigned char bytes[3];
    for (std::size_t c = 0; c < 3; ++c) bytes[c] = static_cast<unsigned char>(std::lround(255 * color[c]));
    colors_->InsertNextTypedTuple(bytes);
  }

  // `y` is the middle of the line.
  void text(double x, double y, const std::string& words, double height, bool bold = false,
            Align align = Align::kLeft, const Rgb& color = kInk) {
    vtkNew<vtkTextActor> actor;
    actor->SetInput(words.c_str());
    actor->SetTextScaleModeToNone();
    vtkTextProperty& property = *actor->GetTextProperty();
    property.SetFontFamilyToArial();
    property.SetFontSize(std::max(1, static_cast<int>(std::lround(height * pixels_))));
    property.SetBold(bold);
    property.SetColor(color[0], color[1], color[2]);
    property.SetVerticalJustificationToCentered();
    if (align == Align::kCentre) property.SetJustificationToCentered();
    if (align == Align::kRight) property.SetJustificationToRight();
    actor->SetPosition(x * pixels_, y * pixels_);
    renderer_.AddActor2D(actor);
  }

  void finish() {
    vtkNew<vtkPolyData> data;
    data->SetPoints(points_);
    data->SetPolys(quads_);
    data->GetCellData()->SetScalars(colors_);
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(data);
    vtkNew<vtkActor2D> actor;
    actor->SetMapper(mapper);
    renderer_.AddActor2D(actor);
  }

 private:
  vtkRenderer& renderer_;
  double pixels_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> quads_;
  vtkNew<vtkUnsignedCharArray> colors_;
};

// Breaks a line between words so that it stays in the caption's column.
std::vector<std::string> wrapped(const std::string& line, std::size_t longest) {
  std::vector<std::string> lines;
  std::string rest = line;
  while (rest.size() > longest) {
    std::size_t cut = rest.rfind(' ', longest);
    if (cut == std::string::npos || cut == 0) break;
    lines.push_back(rest.substr(0, cut));
    rest = rest.substr(cut + 1);
  }
  lines.push_back(rest);
  return lines;
}

void draw_caption(Canvas& canvas, const Scene& scene, double top) {
  constexpr std::size_t kColumn = 34;  // letters that fit left of the geometry
  double y = top - 30;
  canvas.text(24, y, scene.title, 22, true);
  y -= 32;
  if (!scene.verdict.empty()) {
    canvas.text(24, y, scene.verdict, 16, true, Align::kLeft, scene.verdict_good ? kGoodColor : kBadColor);
    y -= 28;
  }
  for (const std::string& line : scene.caption) {
    for (const std::string& part : wrapped(line, kColumn)) {
      canvas.text(24, y, part, 15);
      y -= 22;
    }
    y -= 4;
  }
}

void draw_keys(Canvas& canvas, const Scene& scene) {
  struct Key {
    Rgb color;
    std::string words;
    double height;  // of the swatch: a line or an area
  };
  std::vector<Key> keys;
  if (!scene.scale && !scene.cut.triangles.empty()) {
    const std::size_t shown = std::min<std::size_t>(scene.strip_names.size(), 8);
    for (std::size_t i = 0; i < shown; ++i) {
      keys.push_back({strip_color(static_cast<int>(i)), scene.strip_names[i], 12});
    }
  }
  if (!scene.design.triangles.empty()) {
    keys.push_back({kDesignColor, scene.cut.triangles.empty() ? "design" : "design, not cut", 12});
  }
  if (!scene.ribs.empty()) keys.push_back({kRibColor, "planned ribs", 3});
  if (!scene.blades.empty()) keys.push_back({kBladeColor, scene.blade_note, 3});
  if (scene.blade_now) keys.push_back({kBladeNowColor, scene.blade_note, 4});
  if (!scene.clamps_a.empty()) {
    keys.push_back({kClampAColor, "clamp A", 12});
    keys.push_back({kClampBColor, "clamp B", 12});
  }
  if (!scene.stocks.empty()) keys.push_back({kStockColor, "foam block", 3});
  double y = 26 + 24 * (static_cast<double>(keys.size()) - 1);
  for (const Key& key : keys) {
    canvas.rectangle(24, y - key.height / 2, 24, key.height, key.color);
    canvas.text(58, y, key.words, 15);
    y -= 24;
  }
}

void draw_tick(Canvas& canvas, double bar_x, double y, const std::string& words, bool bold) {
  canvas.rectangle(bar_x - 6, y - 0.75, 6, 1.5, kInk);
  canvas.text(bar_x - 12, y, words, 14, bold, Align::kRight);
}

void draw_bar(Canvas& canvas, const ColorScale& scale, PictureSize size, double pixels) {
  const double width = 22, right = size.width / pixels - 28, x = right - width;
  const double height = 380, bottom = (size.height / pixels - height) / 2 - 10;
  constexpr int kSteps = 190;
  for (int step = 0; step < kSteps; ++step) {
    const double value = scale.low + (step + 0.5) / kSteps * (scale.high - scale.low);
    canvas.rectangle(x, bottom + step * height / kSteps, width, height / kSteps + 0.01,
                     color_at(scale, value));
  }
  canvas.rectangle(x - 1, bottom - 1, width + 2, 1, kInk);
  canvas.rectangle(x - 1, bottom + height, width + 2, 1, kInk);
  canvas.rectangle(x - 1, bottom, 1, height, kInk);
  canvas.rectangle(x + width, bottom, 1, height, kInk);
  const auto place = [&](double value) {
    return bottom + (value - scale.low) / (scale.high - scale.low) * height;
  };
  canvas.text(right, bottom + height + 30, scale.title, 16, true, Align::kRight);
  if (!scale.tolerance) {
    for (int tick = 0; tick <= 4; ++tick) {
      const double value = scale.low + tick / 4.0 * (scale.high - scale.low);
      draw_tick(canvas, x, place(value), fmt::format("{:.3g}", value), false);
    }
    return;
  }
  const double tolerance = *scale.tolerance;
  canvas.text(right, bottom + height + 56, "foam left standing: +", 13, false, Align::kRight);
  draw_tick(canvas, x, place(scale.high), fmt::format("+{:g}", scale.high), false);
  draw_tick(canvas, x, place(tolerance), fmt::format("tolerance +{:g}", tolerance), true);
  draw_tick(canvas, x, place(0), "0", false);
  draw_tick(canvas, x, place(-tolerance), fmt::format("tolerance -{:g}", tolerance), true);
  draw_tick(canvas, x, place(scale.low), fmt::format("{:g}", scale.low), false);
  canvas.text(right, bottom - 26, "cut too deep: -", 13, false, Align::kRight);
}

}  // namespace

Margins overlay_margins(PictureSize size) {
  const double scale = overlay_scale(size);
  return {290 * scale, 190 * scale, 24 * scale, 24 * scale};
}

void add_overlay(const Scene& scene, vtkRenderer& renderer, PictureSize size, double zoom) {
  const double scale = overlay_scale(size);
  Canvas canvas(renderer, scale * zoom);
  draw_caption(canvas, scene, size.height / scale);
  draw_keys(canvas, scene);
  if (scene.scale) draw_bar(canvas, *scene.scale, size, scale);
  canvas.finish();
}

}  // namespace hotblade::pipeline::preview
