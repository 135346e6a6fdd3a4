#include "surface/read/spread_fans.hpp"

#include <Eigen/Geometry>
#include <atomic>

#include "surface/read/half_edges.hpp"
#include "surface/read/sure_sign.hpp"

namespace hotblade::surface {
namespace {

constexpr char kNotYet = 0, kYes = 1, kNo = 2;

// The edges that leave a vertex inside the surface, one after another round it, into `edges`; fewer than
// three where it is on the border or has no triangles.
void edges_about(const TriangleMesh& mesh, int v, std::vector<Eigen::Vector3d>& edges) {
  const HalfEdges::Mesh& links = mesh.half_edges().mesh();
  const auto vertices = mesh.vertices();
  edges.clear();
  const HalfEdges::Halfedge first = links.halfedge_handle(OpenMesh::VertexHandle(v));
  if (!first.is_valid() || links.is_boundary(first)) return;
  HalfEdges::Halfedge h = first;
  do {
    edges.push_back(vertices[static_cast<std::size_t>(links.to_vertex_handle(h).idx())] -
                    vertices[static_cast<std::size_t>(v)]);
    h = links.opposite_halfedge_handle(links.prev_halfedge_handle(h));
  } while (h != first);
}

// Do the edges turn once about the vertex as seen along an axis, each step in the same sense and by less than
// half a turn? A difference of coordinates has its exact sign.
bool turn_once(const std::vector<Eigen::Vector3d>& edges, Eigen::Index x, Eigen::Index y, int sense) {
  int turns = 0;
  const Eigen::Vector3d* a = &edges.back();
  for (const Eigen::Vector3d& b : edges) {
    if (sure_sign((*a)[x] * b[y], (*a)[y] * b[x]) != sense) return false;
    turns += (*a)[y] < 0 && b[y] >= 0 ? 1 : 0;
    a = &b;
  }
  return turns == 1;
}

bool is_spread(const std::vector<Eigen::Vector3d>& edges) {
  if (edges.size() < 3) return false;
  Eigen::Vector3d normal = edges.back().cross(edges.front());
  for (std::size_t i = 1; i < edges.size(); ++i) normal += edges[i - 1].cross(edges[i]);
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return turn_once(edges, (axis + 1) % 3, (axis + 2) % 3, normal[axis] < 0 ? -1 : 1);
}

}  // namespace

SpreadFans::SpreadFans(const TriangleMesh& mesh) : mesh_(mesh) {
  if (!mesh.triangles().empty() && mesh.half_edges().plain()) told_.assign(mesh.vertices().size(), kNotYet);
}

// Threads that ask for a vertex at once find the same of it.
bool SpreadFans::holds(int vertex) const {
  if (told_.empty()) return false;
  const std::atomic_ref<char> told(told_[static_cast<std::size_t>(vertex)]);
  char found = told.load(std::memory_order_relaxed);
  if (found == kNotYet) {
    std::vector<Eigen::Vector3d> edges;
    edges_about(mesh_, vertex, edges);
    found = is_spread(edges) ? kYes : kNo;
    told.store(found, std::memory_order_relaxed);
  }
  return found == kYes;
}

}  // namespace hotblade::surface
