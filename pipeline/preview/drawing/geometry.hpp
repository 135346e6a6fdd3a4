// The scene's geometry as VTK data.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "pipeline/preview/scene.hpp"

class vtkPolyData;

namespace hotblade::pipeline::preview {

void set_mesh(vtkPolyData& data, std::span<const Eigen::Vector3d> vertices,
              std::span<const std::array<int, 3>> triangles);
void set_lines(vtkPolyData& data, const std::vector<Polyline>& lines);

// Three circles about a place, one across each axis: a ring from wherever it is looked at.
[[nodiscard]] std::vector<Polyline> rings_about(const Eigen::Vector3d& place, double radius_mm);

}  // namespace hotblade::pipeline::preview
