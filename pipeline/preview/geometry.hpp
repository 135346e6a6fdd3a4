// The scene's geometry as VTK data.
#pragma once

#include "pipeline/preview/scene.hpp"

class vtkPolyData;

namespace hotblade::pipeline::preview {

void set_mesh(vtkPolyData& data, const std::vector<Eigen::Vector3d>& vertices,
              const std::vector<std::array<int, 3>>& triangles);
void set_lines(vtkPolyData& data, const std::vector<Polyline>& lines);

// The twelve edges of every block.
[[nodiscard]] std::vector<Polyline> block_edges(const std::vector<Block>& blocks);

}  // namespace hotblade::pipeline::preview
