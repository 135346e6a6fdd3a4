// Flat curves as a drawing for CAD: DXF of AutoCAD 2000 (AC1015), the oldest version that can say its unit.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace hotblade::pipeline {

// A vertex of a curve, and how the curve goes on from it: the tangent of a quarter of the turning to the
// next vertex, 0 for a line (DXF reference, LWPOLYLINE group 42).
struct DxfVertex {
  Eigen::Vector2d at;
  double bulge = 0;
};

// An open polyline with its name as text, both on a layer of that name.
struct DxfCurve {
  std::string name, note;  // note: a comment before the entity
  std::vector<DxfVertex> vertices;
  Eigen::Vector2d label{0, 0};  // lower left corner of the name
};

// The text of a drawing, with coordinates in mm to a nanometre. Names are taken as they are: letters, digits
// and `_` are safe.
[[nodiscard]] std::string dxf_document(const std::vector<DxfCurve>& curves, double text_height_mm);

}  // namespace hotblade::pipeline
