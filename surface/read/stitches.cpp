#include "surface/read/stitches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <unordered_map>

#include "surface/read/first_of_equals.hpp"

namespace hotblade::surface {
namespace {

std::size_t slot(int i) {
  return static_cast<std::size_t>(i);
}

// Vertices on a border, in order.
std::vector<int> border_vertices(const TriangleMesh& mesh) {
  std::vector<int> members;
  for (const int c : mesh.border())
    members.insert(members.end(), {vertex_at(mesh, c), vertex_at(mesh, next_corner(c))});
  std::sort(members.begin(), members.end());
  members.erase(std::unique(members.begin(), members.end()), members.end());
  return members;
}

// Vertices by the cell of a grid as wide as the distance: who is near lies in one of 27 cells.
class Cells {
 public:
  Cells(std::span<const Eigen::Vector3d> vertices, std::span<const int> members, double width)
      : vertices_(vertices), width_(width) {
    for (const int v : members) cells_[key(cell(v))].push_back(v);
  }

  template <class Visit>
  void near(int v, const Visit& visit) const {
    const auto centre = cell(v);
    for (std::int64_t k = 0; k < 27; ++k) {
      const auto found =
          cells_.find(key({centre[0] + k % 3 - 1, centre[1] + k / 3 % 3 - 1, centre[2] + k / 9 - 1}));
      if (found == cells_.end()) continue;
      for (const int w : found->second) visit(w);
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] Cell cell(int v) const {
    Cell c;
    for (std::size_t i = 0; i < 3; ++i)
      c[i] = static_cast<std::int64_t>(std::floor(vertices_[slot(v)][static_cast<Eigen::Index>(i)] / width_));
    return c;
  }
  // Cells of one key share a list: a far vertex more to look at, never a near one less.
  static std::uint64_t key(const Cell& c) {
    std::uint64_t h = 0;
    for (const std::int64_t i : c) h = stir(h, static_cast<std::uint64_t>(i));
    return h;
  }

  std::span<const Eigen::Vector3d> vertices_;
  double width_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

struct Pair {
  double distance;
  int a, b;
};

std::vector<Pair> close_pairs(std::span<const Eigen::Vector3d> vertices, std::span<const int> members,
                              double distance) {
  const Cells cells(vertices, members, distance);
  std::vector<Pair> pairs;
  for (const int v : members) {
    cells.near(v, [&](int w) {
      const double d = (vertices[slot(v)] - vertices[slot(w)]).norm();
      if (v < w && d <= distance) pairs.push_back({d, v, w});
    });
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) {
    return std::tie(p.distance, p.a, p.b) < std::tie(q.distance, q.a, q.b);
  });
  return pairs;
}

// Vertices joined so far, each group under its lowest number.
class Groups {
 public:
  explicit Groups(const TriangleMesh& mesh) : mesh_(mesh), lowest_(mesh.vertices().size()) {
    std::iota(lowest_.begin(), lowest_.end(), 0);
  }

  // Joins the groups of both, unless that joins the ends of an edge.
  void join(int a, int b) {
    const int low = std::min(lowest_[slot(a)], lowest_[slot(b)]),
              high = std::max(lowest_[slot(a)], lowest_[slot(b)]);
    if (low == high) return;
    std::vector<int>& into = members(low);
    std::vector<int>& from = members(high);
    for (const int v : into) {
      for (const int w : from) {
        if (mesh_.joined(v, w)) return;
      }
    }
    for (const int w : from) lowest_[slot(w)] = low;
    into.insert(into.end(), from.begin(), from.end());
    from.clear();
  }

  std::vector<int> take() { return std::move(lowest_); }

 private:
  std::vector<int>& members(int low) {
    std::vector<int>& list = members_[low];
    if (list.empty()) list.push_back(low);
    return list;
  }

  const TriangleMesh& mesh_;
  std::vector<int> lowest_;
  std::unordered_map<int, std::vector<int>> members_;
};

}  // namespace

Stitches find_stitches(const TriangleMesh& mesh, double distance_mm) {
  const auto vertices = mesh.vertices();
  Groups groups(mesh);
  for (const Pair& p : close_pairs(vertices, border_vertices(mesh), distance_mm)) groups.join(p.a, p.b);
  Stitches result;
  result.vertex = groups.take();
  for (std::size_t v = 0; v < result.vertex.size(); ++v) {
    const int stands = result.vertex[v];
    if (stands == static_cast<int>(v)) continue;
    if (result.joined++ == 0) result.first = static_cast<int>(v);
    result.largest_move_mm = std::max(result.largest_move_mm, (vertices[v] - vertices[slot(stands)]).norm());
  }
  return result;
}

}  // namespace hotblade::surface
