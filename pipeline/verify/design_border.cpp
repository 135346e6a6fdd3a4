#include "pipeline/verify/design_border.hpp"

#include <algorithm>
#include <array>

namespace hotblade::pipeline {

bool lies_on(const MeshView& mesh, const gpu::Nearest& nearest, const std::function<bool(int)>& vertex,
             const std::function<bool(int)>& edge) {
  constexpr double kOnEdge = 1e-7;  // shares of area below this are rounding
  const auto& t = mesh.triangles[static_cast<std::size_t>(nearest.triangle)];
  if (std::none_of(t.begin(), t.end(), vertex)) return false;
  const Facet f = facet(mesh, nearest.triangle);
  const double area = f.area();
  if (!(area > 0)) return false;
  const std::array<double, 3> share{Facet{nearest.point, f.b, f.c}.area() / area,
                                    Facet{f.a, nearest.point, f.c}.area() / area,
                                    Facet{f.a, f.b, nearest.point}.area() / area};
  for (std::size_t i = 0; i < 3; ++i) {
    if (share[i] > 1 - kOnEdge) return vertex(t[i]);
  }
  for (int i = 0; i < 3; ++i) {
    if (share[static_cast<std::size_t>(i)] < kOnEdge && edge(3 * nearest.triangle + (i + 1) % 3)) return true;
  }
  return false;
}

DesignBorder::DesignBorder(const surface::TriangleMesh& mesh)
    : mesh_(mesh), vertex_(mesh.vertices().size(), false) {
  for (const int c : mesh.border()) {
    vertex_[static_cast<std::size_t>(surface::vertex_at(mesh, c))] =
        vertex_[static_cast<std::size_t>(surface::vertex_at(mesh, surface::next_corner(c)))] = true;
  }
}

bool DesignBorder::holds(const gpu::Nearest& nearest) const {
  return lies_on(
      {mesh_.vertices(), mesh_.triangles()}, nearest,
      [&](int v) { return vertex_[static_cast<std::size_t>(v)]; },
      [&](int corner) { return mesh_.beyond(corner) == surface::TriangleMesh::kNone; });
}

}  // namespace hotblade::pipeline
