#include "pipeline/verify/design_border.hpp"

#include <array>

namespace hotblade::pipeline {

DesignBorder::DesignBorder(const MeshView& mesh)
    : links_(surface::link_faces(mesh.triangles)), vertex_(mesh.vertices.size(), false) {
  for (std::size_t c = 0; c < links_.beyond.size(); ++c) {
    if (!edge(c)) continue;
    const auto& t = mesh.triangles[c / 3];
    vertex_[static_cast<std::size_t>(t[c % 3])] = vertex_[static_cast<std::size_t>(t[(c + 1) % 3])] = true;
  }
}

bool DesignBorder::edge(std::size_t corner) const {
  return links_.beyond[corner] == surface::FaceLinks::kNone;
}

bool DesignBorder::holds(const MeshView& mesh, const gpu::Nearest& nearest) const {
  constexpr double kOnEdge = 1e-7;  // shares of area below this are rounding
  const Facet f = facet(mesh, nearest.triangle);
  const auto& t = mesh.triangles[static_cast<std::size_t>(nearest.triangle)];
  const double area = f.area();
  if (!(area > 0)) return false;
  const std::array<double, 3> share{Facet{nearest.point, f.b, f.c}.area() / area,
                                    Facet{f.a, nearest.point, f.c}.area() / area,
                                    Facet{f.a, f.b, nearest.point}.area() / area};
  for (std::size_t i = 0; i < 3; ++i) {
    if (share[i] > 1 - kOnEdge) return vertex_[static_cast<std::size_t>(t[i])];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (share[i] < kOnEdge && edge(3 * static_cast<std::size_t>(nearest.triangle) + (i + 1) % 3)) return true;
  }
  return false;
}

}  // namespace hotblade::pipeline
