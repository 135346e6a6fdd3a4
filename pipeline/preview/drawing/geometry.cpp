#include "pipeline/preview/drawing/geometry.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <cmath>
#include <numbers>

namespace hotblade::pipeline::preview {
namespace {

vtkNew<vtkPoints> points_of(std::span<const Eigen::Vector3d> places) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    points->SetPoint(static_cast<vtkIdType>(i), places[i].data());
  return points;
}

}  // namespace

void set_mesh(vtkPolyData& data, std::span<const Eigen::Vector3d> vertices,
              std::span<const std::array<int, 3>> triangles) {
  data.SetPoints(points_of(vertices));
  vtkNew<vtkCellArray> cells;
  for (const auto& [a, b, c] : triangles) {
    const vtkIdType ids[3] = {a, b, c};
    cells->InsertNextCell(3, ids);
  }
  data.SetPolys(cells);
}

void set_lines(vtkPolyData& data, const std::vector<Polyline>& lines) {
  std::vector<Eigen::Vector3d> places;
  vtkNew<vtkCellArray> cells;
  for (const Polyline& line : lines) {
    cells->InsertNextCell(static_cast<int>(line.points.size()));
    for (const Eigen::Vector3d& point : line.points) {
      cells->InsertCellPoint(static_cast<vtkIdType>(places.size()));
      places.push_back(point);
    }
  }
  data.SetPoints(points_of(places));
  data.SetLines(cells);
}

std::vector<Polyline> rings_about(const Eigen::Vector3d& place, double radius_mm) {
  constexpr int kCorners = 48;
  std::vector<Polyline> rings;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d u = Eigen::Vector3d::Unit((axis + 1) % 3),
                          v = Eigen::Vector3d::Unit((axis + 2) % 3);
    Polyline& ring = rings.emplace_back();
    for (int i = 0; i <= kCorners; ++i) {
      const double turn = 2 * std::numbers::pi * i / kCorners;
      ring.points.emplace_back(place + radius_mm * (std::cos(turn) * u + std::sin(turn) * v));
    }
  }
  return rings;
}

}  // namespace hotblade::pipeline::preview
