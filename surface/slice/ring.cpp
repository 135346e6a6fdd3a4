#include "surface/slice/ring.hpp"

#include <OpenMesh/Core/Mesh/Handles.hh>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "surface/read/half_edges.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// Far above the rounding of angles, far below anything that matters: a nanometre at a metre.
constexpr double kAsideRad = 1e-9;
// Vertices this near to the cut lie on it.
constexpr double kOnRad = 4 * kAsideRad;

class Cut {
 public:
  Cut(const TriangleMesh& mesh, const PlaneFamily& fan) : mesh_(mesh), fan_(fan) {
    out_.vertices.assign(mesh.vertices().begin(), mesh.vertices().end());
  }

  TriangleMesh run() {
    for (const Vector3d& p : mesh_.vertices()) {
      const double past = std::remainder(fan_.angle(fan_.offset(p)) - pi, 2 * pi);
      past_.push_back(std::abs(past) < kOnRad ? 0 : past);
    }
    const HalfEdges::Mesh& edges = mesh_.half_edges().mesh();
    at_edge_.assign(edges.n_edges(), kNotMade);
    at_vertex_.assign(mesh_.vertices().size(), kNotMade);
    for (int f = 0; f < static_cast<int>(mesh_.triangles().size()); ++f) add(f);
    return TriangleMesh(std::move(out_));
  }

 private:
  [[nodiscard]] double past(int v) const { return past_[static_cast<std::size_t>(v)]; }
  [[nodiscard]] const Vector3d& at(int v) const { return mesh_.vertices()[static_cast<std::size_t>(v)]; }

  void add(int face) {
    const auto& t = mesh_.triangles()[static_cast<std::size_t>(face)];
    const double low = std::min({past(t[0]), past(t[1]), past(t[2])}),
                 high = std::max({past(t[0]), past(t[1]), past(t[2])});
    const bool opposite = high - low > pi;  // around offset 0
    if (opposite || (low != 0 && high != 0 && low * high > 0)) {
      out_.triangles.push_back(t);
      return;
    }
    if (high <= 0 || low >= 0) {
      const bool behind = low >= 0 && high > 0;
      out_.triangles.push_back({side_of(t[0], behind), side_of(t[1], behind), side_of(t[2], behind)});
      return;
    }
    fan_out(part(face, false));
    fan_out(part(face, true));
  }

  // The face's corners on one side, with those on the cut, in its sense.
  std::vector<int> part(int face, bool behind) {
    const auto& t = mesh_.triangles()[static_cast<std::size_t>(face)];
    std::vector<int> corners;
    OpenMesh::HalfedgeHandle h = mesh_.half_edges().first(face);
    for (std::size_t i = 0; i < 3; ++i, h = mesh_.half_edges().mesh().next_halfedge_handle(h)) {
      const int a = t[i], b = t[(i + 1) % 3];
      if (past(a) == 0 || (past(a) > 0) == behind) corners.push_back(side_of(a, behind));
      if (past(a) * past(b) < 0) corners.push_back(crossing(h, a, b, behind));
    }
    return corners;
  }

  void fan_out(const std::vector<int>& corners) {
    for (std::size_t i = 2; i < corners.size(); ++i)
      out_.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }

  // Vertices made at an edge or a vertex of the mesh: before the cut and behind it.
  using Made = std::array<int, 2>;
  static constexpr Made kNotMade{-1, -1};

  int side_of(int v, bool behind) {
    if (past(v) != 0) return v;
    return made(at_vertex_[static_cast<std::size_t>(v)], behind, at(v));
  }

  int crossing(OpenMesh::HalfedgeHandle h, int a, int b, bool behind) {
    const int low = std::min(a, b), high = std::max(a, b);
    const Vector3d n = fan_.normal(0);
    const double from = n.dot(at(low) - fan_.centre()), to = n.dot(at(high) - fan_.centre());
    const int edge = mesh_.half_edges().mesh().edge_handle(h).idx();
    return made(at_edge_[static_cast<std::size_t>(edge)], behind,
                at(low) + from / (from - to) * (at(high) - at(low)));
  }

  int made(Made& place, bool behind, const Vector3d& p) {
    int& vertex = place[behind ? 1 : 0];
    if (vertex >= 0) return vertex;
    vertex = static_cast<int>(out_.vertices.size());
    // On the axis' height and distance of p, just before or behind the half plane at half a turn.
    const Vector3d along = fan_.centre() + fan_.axis().dot(p - fan_.centre()) * fan_.axis();
    const Vector3d out = -fan_.axis().cross(fan_.normal(0));  // reference: normal = axis x reference
    const Eigen::AngleAxisd turn(behind ? kAsideRad - pi : pi - kAsideRad, fan_.axis());
    out_.vertices.push_back(along + fan_.distance_from_axis(p) * (turn * out));
    return vertex;
  }

  const TriangleMesh& mesh_;
  const PlaneFamily& fan_;
  TriangleSoup out_;
  std::vector<double> past_;  // of each vertex, rad past the cut, within half a turn; 0: on it
  std::vector<Made> at_edge_, at_vertex_;
};

}  // namespace

TriangleMesh cut_open(const TriangleMesh& mesh, const PlaneFamily& fan) {
  return Cut(mesh, fan).run();
}

}  // namespace hotblade::surface
