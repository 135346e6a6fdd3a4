#include "surface/read/mesh_health.hpp"

#include <Eigen/Geometry>
#include <vector>

#include "surface/read/half_edges.hpp"

namespace hotblade::surface {
namespace {

void measure_borders(const HalfEdges::Mesh& mesh, Health& health) {
  std::vector<bool> seen(mesh.n_halfedges(), false);
  for (const auto start : mesh.halfedges()) {
    if (!start.is_boundary() || seen[static_cast<std::size_t>(start.idx())]) continue;
    ++health.border_loops;
    for (auto h = start; !seen[static_cast<std::size_t>(h.idx())]; h = h.next()) {
      seen[static_cast<std::size_t>(h.idx())] = true;
      health.border_length_mm += mesh.calc_edge_length(h);
    }
  }
  health.closed = health.border_loops == 0;
}

}  // namespace

void measure_mesh(const TriangleMesh& mesh, Health& health) {
  const auto at = [&](int v) -> const Eigen::Vector3d& {
    return mesh.vertices()[static_cast<std::size_t>(v)];
  };
  health.vertices = mesh.vertices().size();
  health.triangles = mesh.triangles().size();
  health.bbox_mm = {at(0), at(0)};
  for (const Eigen::Vector3d& p : mesh.vertices()) {
    health.bbox_mm[0] = health.bbox_mm[0].cwiseMin(p);
    health.bbox_mm[1] = health.bbox_mm[1].cwiseMax(p);
  }
  for (const auto& t : mesh.triangles())
    health.area_mm2 += 0.5 * (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).norm();
  if (!health.blockers.empty()) return;
  if (mesh.half_edges().has_seams()) {
    health.blockers.push_back(
        "OpenMesh cannot hold all faces in one surface: the faces do not form a surface, repair them in the "
        "CAD "
        "program");
    return;
  }
  measure_borders(mesh.half_edges().mesh(), health);
}

}  // namespace hotblade::surface
