#include "pipeline/preview/drawing/canvas.hpp"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hotblade::pipeline::preview {

double overlay_scale(PictureSize size) {
  return std::min(size.width / 1280.0, size.height / 720.0);
}

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

struct Sheets::Layers {
  vtkNew<vtkRenderer> shapes, words;
};

Sheets::Sheets(vtkRenderer& below) : layers_(std::make_unique<Layers>()) {
  vtkRenderWindow& window = *below.GetRenderWindow();
  window.SetNumberOfLayers(3);
  int layer = 1;
  for (vtkRenderer* sheet : {layers_->shapes.Get(), layers_->words.Get()}) {
    sheet->SetLayer(layer++);
    sheet->InteractiveOff();
    window.AddRenderer(sheet);
  }
}

Sheets::~Sheets() = default;

struct Canvas::Actors {
  std::vector<vtkSmartPointer<vtkActor2D>> words, drawn_shapes, drawn_words;
};

Canvas::Canvas(Sheets& sheets, double pixels)
    : sheets_(sheets), pixels_(pixels), actors_(std::make_unique<Actors>()) {}

Canvas::~Canvas() = default;

// What `over` leaves of `under`: below, above, left and right of it.
std::vector<Canvas::Box> Canvas::rest(const Box& under, const Box& over) {
  const double x0 = std::max(under.x0, over.x0), x1 = std::min(under.x1, over.x1);
  const double y0 = std::max(under.y0, over.y0), y1 = std::min(under.y1, over.y1);
  if (x0 >= x1 || y0 >= y1) return {under};
  std::vector<Box> parts;
  if (under.y0 < y0) parts.push_back({under.x0, under.y0, under.x1, y0, under.color});
  if (y1 < under.y1) parts.push_back({under.x0, y1, under.x1, under.y1, under.color});
  if (under.x0 < x0) parts.push_back({under.x0, y0, x0, y1, under.color});
  if (x1 < under.x1) parts.push_back({x1, y0, under.x1, y1, under.color});
  return parts;
}

Canvas::Bytes Canvas::bytes_of(const Rgb& color, double opacity) {
  const auto byte = [](double share) { return static_cast<unsigned char>(std::lround(255 * share)); };
  return {byte(color[0]), byte(color[1]), byte(color[2]), byte(opacity)};
}

void Canvas::rectangle(double x, double y, double width, double height, const Rgb& color, double opacity) {
  const Box box{x, y, x + width, y + height, bytes_of(color, opacity)};
  std::vector<Box> left;
  for (const Box& under : boxes_) {
    for (const Box& part : rest(under, box)) left.push_back(part);
  }
  left.push_back(box);
  boxes_ = std::move(left);
}

void Canvas::triangle(const Triangle& corners, const Rgb& color) {
  triangles_.emplace_back(corners, bytes_of(color, 1));
}

void Canvas::text(double x, double y, const std::string& words, double height, bool bold, Align align,
                  const Rgb& color) {
  const auto actor = vtkSmartPointer<vtkTextActor>::New();
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
  actors_->words.emplace_back(actor);
}

void Canvas::draw_shapes() {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(4);
  const auto add = [&](std::initializer_list<std::array<double, 2>> corners, const Bytes& color) {
    cells->InsertNextCell(static_cast<int>(corners.size()));
    for (const auto& [x, y] : corners)
      cells->InsertCellPoint(points->InsertNextPoint(x * pixels_, y * pixels_, 0));
    colors->InsertNextTypedTuple(color.data());
  };
  for (const Box& b : boxes_) add({{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}}, b.color);
  for (const auto& [t, color] : triangles_) add({t[0], t[1], t[2]}, color);
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(cells);
  data->GetCellData()->SetScalars(colors);
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(data);
  const auto actor = vtkSmartPointer<vtkActor2D>::New();
  actor->SetMapper(mapper);
  sheets_.layers_->shapes->AddActor2D(actor);
  actors_->drawn_shapes.push_back(actor);
}

void Canvas::finish() {
  vtkRenderer &shapes = *sheets_.layers_->shapes, &words = *sheets_.layers_->words;
  for (const auto& actor : actors_->drawn_shapes) shapes.RemoveActor2D(actor);
  for (const auto& actor : actors_->drawn_words) words.RemoveActor2D(actor);
  actors_->drawn_shapes.clear();
  if (!boxes_.empty() || !triangles_.empty()) draw_shapes();
  actors_->drawn_words = std::move(actors_->words);
  for (const auto& actor : actors_->drawn_words) words.AddActor2D(actor);
  boxes_.clear();
  triangles_.clear();
  actors_->words.clear();
}

}  // namespace hotblade::pipeline::preview
