#include "surface/read/mesh_health.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <vector>

#include "surface/read/blocks.hpp"
#include "surface/read/half_edges.hpp"

namespace hotblade::surface {
namespace {

void measure_borders(const HalfEdges& half_edges, Health& health) {
  const HalfEdges::Mesh& mesh = half_edges.mesh();
  // Outside half-edges, in their order.
  std::vector<int> outside;
  for (const int corner : half_edges.border())
    outside.push_back(mesh.opposite_halfedge_handle(half_edges.at_corner(corner)).idx());
  std::sort(outside.begin(), outside.end());
  std::vector<bool> seen(outside.size(), false);
  const auto place = [&](int h) {
    return static_cast<std::size_t>(std::lower_bound(outside.begin(), outside.end(), h) - outside.begin());
  };
  for (std::size_t i = 0; i < outside.size(); ++i) {
    if (seen[i]) continue;
    ++health.border_loops;
    HalfEdges::Halfedge h(outside[i]);
    for (std::size_t k = i; !seen[k]; k = place(h.idx())) {
      seen[k] = true;
      health.border_length_mm += mesh.calc_edge_length(h);
      h = mesh.next_halfedge_handle(h);
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
  // Blocks are measured side by side and added in their order.
  constexpr std::size_t kBlockTriangles = 1 << 18;
  struct Part {
    double area = 0;
    std::array<Eigen::Vector3d, 2> box;
  };
  std::vector<Part> parts((health.triangles + kBlockTriangles - 1) / kBlockTriangles);
  for_blocks(health.triangles, kBlockTriangles, [&](std::size_t from, std::size_t to) {
    Part part{0, {at(mesh.triangles()[from][0]), at(mesh.triangles()[from][0])}};
    for (std::size_t f = from; f < to; ++f) {
      const auto& t = mesh.triangles()[f];
      for (const int v : t) {
        part.box[0] = part.box[0].cwiseMin(at(v));
        part.box[1] = part.box[1].cwiseMax(at(v));
      }
      part.area += 0.5 * (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).norm();
    }
    parts[from / kBlockTriangles] = part;
  });
  health.bbox_mm = parts.front().box;
  for (const Part& part : parts) {
    health.area_mm2 += part.area;
    health.bbox_mm[0] = health.bbox_mm[0].cwiseMin(part.box[0]);
    health.bbox_mm[1] = health.bbox_mm[1].cwiseMax(part.box[1]);
  }
  if (!health.blockers.empty()) return;
  if (mesh.half_edges().has_seams()) {
    health.blockers.push_back(
        "OpenMesh cannot hold all faces in one surface: the faces do not form a surface, repair them in the "
        "CAD "
        "program");
    return;
  }
  measure_borders(mesh.half_edges(), health);
}

}  // namespace hotblade::surface
