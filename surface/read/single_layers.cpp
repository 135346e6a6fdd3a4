#include "surface/read/single_layers.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "surface/read/blocks.hpp"
#include "surface/read/half_edges.hpp"
#include "surface/read/sure_sign.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;

// Axes 0 to 5 are x, -x, y, -y, z, -z, looked along from far out towards the origin.
constexpr int kAxes = 6;

// The axes, as bits, that a triangle is surely seen along from its front.
unsigned seen_along(std::span<const Vector3d> vertices, const std::array<int, 3>& t) {
  const auto at = [&](std::size_t i) -> const Vector3d& { return vertices[static_cast<std::size_t>(t[i])]; };
  const Vector3d a = at(1) - at(0), b = at(2) - at(0);
  unsigned axes = 0;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Eigen::Index u = (k + 1) % 3, v = (k + 2) % 3;
    const int sign = sure_sign(a[u] * b[v], a[v] * b[u]);
    if (sign != 0) axes |= 1U << (2 * k + (sign > 0 ? 0 : 1));
  }
  return axes;
}

// A point as seen along an axis.
struct Seen {
  double u, v;
  friend bool operator<(const Seen& p, const Seen& q) { return p.u != q.u ? p.u < q.u : p.v < q.v; }
};

Seen seen(const Vector3d& p, int axis) {
  const Eigen::Index k = axis / 2, u = (k + 1) % 3, v = (k + 2) % 3;
  return axis % 2 == 0 ? Seen{p[u], p[v]} : Seen{p[v], p[u]};
}

// 1 where a, b and c surely go round to the left, -1 to the right, 0: not known.
int turn(const Seen& a, const Seen& b, const Seen& c) {
  return sure_sign((b.u - a.u) * (c.v - a.v), (b.v - a.v) * (c.u - a.u));
}

// An edge of the border, with the set on its left.
struct Edge {
  int from, to;  // vertices
  Seen a, b;
  Seen low, high;  // its box
};

// The border of a set of faces that are all seen from their front. How often the set covers a place is 0 far
// out and changes by one where an edge is crossed, so it has to be shown to be 0 on every edge's right.
class Border {
 public:
  void add(int from, int to, const Seen& a, const Seen& b) {
    edges_.push_back(
        {from, to, a, b, {std::min(a.u, b.u), std::min(a.v, b.v)}, {std::max(a.u, b.u), std::max(a.v, b.v)}});
  }

  // Is it proved that the set covers no place twice?
  bool covers_once() { return meets_itself_in_vertices_only() && alternates() && has_nothing_on_its_right(); }

 private:
  struct End {
    int vertex, edge;
    bool out;
  };

  // Do two edges surely have nothing in common but a vertex of both?
  static bool part(const Edge& e, const Edge& f) {
    const bool after = e.to == f.from, before = e.from == f.to;
    if (after && before) return false;
    if (after) return leave_apart(e.b, e.a, f.b);
    if (before) return leave_apart(e.a, e.b, f.a);
    if (e.from == f.from) return leave_apart(e.a, e.b, f.b);
    if (e.to == f.to) return leave_apart(e.b, e.a, f.a);
    return turn(e.a, e.b, f.a) * turn(e.a, e.b, f.b) > 0 || turn(f.a, f.b, e.a) * turn(f.a, f.b, e.b) > 0;
  }

  // Do the ways from p to x and to y surely differ in direction?
  static bool leave_apart(const Seen& p, const Seen& x, const Seen& y) {
    return turn(p, x, y) != 0 || sure_sign((x.u - p.u) * (y.u - p.u), -(x.v - p.v) * (y.v - p.v)) < 0;
  }

  bool meets_itself_in_vertices_only() {
    std::sort(edges_.begin(), edges_.end(), [](const Edge& e, const Edge& f) { return e.low < f.low; });
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const Edge& e = edges_[i];
      for (std::size_t k = i + 1; k < edges_.size() && edges_[k].low.u <= e.high.u; ++k) {
        const Edge& f = edges_[k];
        if (f.low.v <= e.high.v && e.low.v <= f.high.v && !part(e, f)) return false;
      }
    }
    return true;
  }

  [[nodiscard]] const Seen& start(const End& end) const {
    const Edge& e = edges_[static_cast<std::size_t>(end.edge)];
    return end.out ? e.a : e.b;
  }
  [[nodiscard]] const Seen& far(const End& end) const {
    const Edge& e = edges_[static_cast<std::size_t>(end.edge)];
    return end.out ? e.b : e.a;
  }

  // Do edges that come in and go out take turns about every vertex? Then what is on the right of edges that
  // hang together is the same everywhere. Joins those edges.
  bool alternates() {
    ends_.clear();
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      ends_.push_back({edges_[i].from, static_cast<int>(i), true});
      ends_.push_back({edges_[i].to, static_cast<int>(i), false});
    }
    std::sort(ends_.begin(), ends_.end(), [](const End& x, const End& y) {
      return x.vertex != y.vertex ? x.vertex < y.vertex : x.edge < y.edge;
    });
    piece_.resize(edges_.size());
    std::iota(piece_.begin(), piece_.end(), 0);
    for (std::size_t from = 0, to = 0; from < ends_.size(); from = to) {
      while (to < ends_.size() && ends_[to].vertex == ends_[from].vertex) ++to;
      const std::span<End> own = std::span(ends_).subspan(from, to - from);
      for (const End& end : own) join(own[0].edge, end.edge);
      if (own.size() > 2 && !sort_about_vertex(own)) return false;
      for (std::size_t i = 0; i < own.size(); ++i)
        if (own[i].out == own[(i + 1) % own.size()].out) return false;
    }
    return true;
  }

  // False where rounding may have made the order.
  bool sort_about_vertex(std::span<End> ends) const {
    const Seen& p = start(ends[0]);
    const auto upper = [&](const End& end) {
      const Seen& q = far(end);
      return q.v > p.v || (q.v == p.v && q.u > p.u);
    };
    for (std::size_t i = 0; i < ends.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        if (upper(ends[i]) == upper(ends[k]) && turn(p, far(ends[i]), far(ends[k])) == 0) return false;
    std::sort(ends.begin(), ends.end(), [&](const End& x, const End& y) {
      return upper(x) != upper(y) ? upper(x) : turn(p, far(x), far(y)) > 0;
    });
    return true;
  }

  int root(int edge) const {
    while (piece_[static_cast<std::size_t>(edge)] != edge) edge = piece_[static_cast<std::size_t>(edge)];
    return edge;
  }
  void join(int edge, int other) {
    const int a = root(edge), b = root(other);
    piece_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }

  // A piece that is alone has the unbounded outside beside it, and nothing covers a place less than no times.
  // Of several each is looked at from its leftmost vertex: outside of it the others cover nothing where it
  // is a rim, and once where it is the rim of a hole.
  bool has_nothing_on_its_right() {
    for (std::size_t i = 0; i < piece_.size(); ++i) piece_[i] = root(static_cast<int>(i));
    for (std::size_t i = 0; i < piece_.size(); ++i) {
      if (piece_[i] != static_cast<int>(i)) continue;
      if (i == 0 && std::all_of(piece_.begin(), piece_.end(), [](int p) { return p == 0; })) return true;
      const End leftmost = leftmost_of(static_cast<int>(i));
      const std::optional<int> covered = covered_by_others(static_cast<int>(i), start(leftmost));
      if (!covered || *covered != (leftmost.out ? 0 : 1)) return false;
    }
    return true;
  }

  // At the leftmost vertex of a piece, its edge with nothing of the piece clockwise of it.
  [[nodiscard]] End leftmost_of(int piece) const {
    std::optional<End> best;
    for (const End& end : ends_) {
      if (piece_[static_cast<std::size_t>(end.edge)] != piece) continue;
      const bool further = best && start(end) < start(*best),
                 lower = best && end.vertex == best->vertex && turn(start(end), far(*best), far(end)) < 0;
      if (!best || further || lower) best = end;
    }
    return *best;
  }

  // How often the other pieces' edges go round a place; nothing where rounding may decide.
  [[nodiscard]] std::optional<int> covered_by_others(int piece, const Seen& p) const {
    int winding = 0;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const Edge& e = edges_[i];
      if (piece_[i] == piece || (e.a.v <= p.v) == (e.b.v <= p.v)) continue;
      const int side = turn(e.a, e.b, p);
      if (side == 0) return std::nullopt;
      const bool up = e.a.v <= p.v;
      if (up && side > 0) ++winding;
      if (!up && side < 0) --winding;
    }
    return winding;
  }

  std::vector<Edge> edges_;
  std::vector<End> ends_;
  std::vector<int> piece_;  // of each edge: one that it hangs together with
};

}  // namespace

SingleLayers::SingleLayers(const TriangleMesh& mesh, std::span<const int> order)
    : mesh_(mesh), order_(order), place_(order.size()) {
  if (order.size() != mesh.triangles().size() || (!order.empty() && !mesh.half_edges().plain()))
    throw std::logic_error("SingleLayers: needs a plain surface and each of its faces once");
  for_blocks(order.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) place_[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  });
}

unsigned SingleLayers::fronts(std::size_t first, std::size_t count) const {
  unsigned axes = (1U << kAxes) - 1;
  for (std::size_t i = first; i < first + count && axes != 0; ++i)
    axes &= seen_along(mesh_.vertices(), mesh_.triangles()[static_cast<std::size_t>(order_[i])]);
  return axes;
}

int SingleLayers::widest(std::size_t first, std::size_t count, unsigned axes) const {
  constexpr std::size_t kLooks = 16;  // of any faces: they say enough of the rest, and the border decides
  Vector3d sum = Vector3d::Zero();
  for (std::size_t k = 0; k < kLooks; ++k) {
    const auto& t = mesh_.triangles()[static_cast<std::size_t>(order_[first + k * count / kLooks])];
    const auto at = [&](std::size_t i) { return mesh_.vertices()[static_cast<std::size_t>(t[i])]; };
    sum += (at(1) - at(0)).cross(at(2) - at(0));
  }
  int best = -1;
  double most = -std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < kAxes; ++axis) {
    const double along = sum[axis / 2] * (axis % 2 == 0 ? 1 : -1);
    if ((axes >> axis & 1U) == 0 || !(along > most)) continue;
    best = axis;
    most = along;
  }
  return best;
}

bool SingleLayers::holds(std::size_t first, std::size_t count) const {
  const unsigned axes = fronts(first, count);
  const int axis = axes == 0 ? -1 : widest(first, count, axes);
  if (axis < 0) return false;
  const HalfEdges::Mesh& links = mesh_.half_edges().mesh();
  const auto vertices = mesh_.vertices();
  Border border;
  for (std::size_t i = first; i < first + count; ++i) {
    const auto& t = mesh_.triangles()[static_cast<std::size_t>(order_[i])];
    // A face's half-edge is the one before its first corner's (half_edges.hpp).
    HalfEdges::Halfedge h = links.halfedge_handle(OpenMesh::FaceHandle(order_[i]));
    for (std::size_t k = 2; k < 5; ++k, h = links.next_halfedge_handle(h)) {
      const int beyond = links.face_handle(links.opposite_halfedge_handle(h)).idx();
      if (beyond >= 0) {
        const auto there = static_cast<std::size_t>(place_[static_cast<std::size_t>(beyond)]);
        if (there - first < count) continue;  // below `first` the difference is a huge number
      }
      const int from = t[k % 3], to = t[(k + 1) % 3];
      border.add(from, to, seen(vertices[static_cast<std::size_t>(from)], axis),
                 seen(vertices[static_cast<std::size_t>(to)], axis));
    }
  }
  return border.covers_once();
}

}  // namespace hotblade::surface
