// The sample designs as formulas, and how finely each is meshed. mm, +z up.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace hotblade::samples {

// A surface over the rectangle [0, u_mm] x [0, v_mm], meshed by u_cells x v_cells rectangles of two triangles
// each.
struct SampleSurface {
  std::string name;
  std::string about;  // one line for the OBJ's head
  double u_mm, v_mm;
  int u_cells, v_cells;
  Eigen::Vector3d (*point)(double u, double v);
};

[[nodiscard]] std::vector<SampleSurface> sample_surfaces();

// The OBJ text of a sample: vertices to 1e-6 mm, faces counter-clockwise seen from the side of u x v.
[[nodiscard]] std::string obj_text(const SampleSurface& surface);

}  // namespace hotblade::samples
