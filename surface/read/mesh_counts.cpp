#include "surface/read/mesh_counts.hpp"

#include <Eigen/Geometry>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>

namespace hotblade::surface {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using HalfedgeMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

HalfedgeMesh to_halfedges(const TriangleMesh& mesh, std::size_t edges) {
  omerr().disable();  // refused faces are counted here, not printed by the library
  HalfedgeMesh halfedges;
  halfedges.reserve(mesh.vertices.size(), edges, mesh.triangles.size());
  for (const Eigen::Vector3d& p : mesh.vertices) halfedges.add_vertex({p.x(), p.y(), p.z()});
  for (const auto& t : mesh.triangles) {
    halfedges.add_face(HalfedgeMesh::VertexHandle(t[0]), HalfedgeMesh::VertexHandle(t[1]),
                       HalfedgeMesh::VertexHandle(t[2]));
  }
  return halfedges;
}

void measure_borders(const HalfedgeMesh& halfedges, Health& health) {
  std::vector<bool> seen(halfedges.n_halfedges(), false);
  for (const auto start : halfedges.halfedges()) {
    if (!start.is_boundary() || seen[static_cast<std::size_t>(start.idx())]) continue;
    ++health.border_loops;
    for (auto h = start; !seen[static_cast<std::size_t>(h.idx())]; h = h.next()) {
      seen[static_cast<std::size_t>(h.idx())] = true;
      health.border_length_mm += halfedges.calc_edge_length(h);
    }
  }
  health.closed = health.border_loops == 0;
}

void compare_counts(const HalfedgeMesh& halfedges, const RepairedMesh& repaired, Health& health) {
  const auto differs = [&](const char* what, std::size_t wanted, std::size_t found) {
    if (wanted == found) return;
    health.blockers.push_back("OpenMesh holds another number of " + std::string(what) + " than the file (" +
                              std::to_string(found) + ", should be " + std::to_string(wanted) +
                              "): the faces do not form a surface, repair them in the CAD program");
  };
  differs("vertices", repaired.mesh.vertices.size(), halfedges.n_vertices());
  differs("faces", repaired.mesh.triangles.size(), halfedges.n_faces());
  differs("edges", repaired.edges, halfedges.n_edges());
  std::size_t pinched = 0;
  for (const auto v : halfedges.vertices()) pinched += halfedges.is_manifold(v) ? 0U : 1U;
  differs("vertices with several fans of faces", 0, pinched);
}

}  // namespace

void measure_mesh(const RepairedMesh& repaired, Health& health) {
  const TriangleMesh& mesh = repaired.mesh;
  health.vertices = mesh.vertices.size();
  health.triangles = mesh.triangles.size();
  health.bbox_mm = {mesh.vertices.front(), mesh.vertices.front()};
  for (const Eigen::Vector3d& p : mesh.vertices) {
    health.bbox_mm[0] = health.bbox_mm[0].cwiseMin(p);
    health.bbox_mm[1] = health.bbox_mm[1].cwiseMax(p);
  }
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices[static_cast<std::size_t>(t[0])];
    const Eigen::Vector3d& b = mesh.vertices[static_cast<std::size_t>(t[1])];
    const Eigen::Vector3d& c = mesh.vertices[static_cast<std::size_t>(t[2])];
    health.area_mm2 += 0.5 * (b - a).cross(c - a).norm();
  }
  if (!health.blockers.empty()) return;
  const HalfedgeMesh halfedges = to_halfedges(mesh, repaired.edges);
  compare_counts(halfedges, repaired, health);
  if (health.blockers.empty()) measure_borders(halfedges, health);
}

}  // namespace hotblade::surface
