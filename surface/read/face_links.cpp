#include "surface/read/face_links.hpp"

#include <algorithm>
#include <compare>
#include <numeric>

namespace hotblade::surface {
namespace {

// A corner's edge, listed at its smaller vertex.
struct EdgeUse {
  int far;  // the greater vertex
  int corner;
  auto operator<=>(const EdgeUse&) const = default;
};

// Vertex v's uses are uses[first[v]] .. uses[first[v + 1]], sorted.
struct EdgeUses {
  std::vector<std::size_t> first;
  std::vector<EdgeUse> uses;
};

EdgeUses sort_edge_uses(std::span<const std::array<int, 3>> triangles) {
  int vertices = 0;
  for (const auto& t : triangles) vertices = std::max({vertices, t[0] + 1, t[1] + 1, t[2] + 1});
  const auto near = [&](std::size_t c) {
    return static_cast<std::size_t>(std::min(triangles[c / 3][c % 3], triangles[c / 3][(c + 1) % 3]));
  };
  EdgeUses sorted;
  sorted.first.assign(static_cast<std::size_t>(vertices) + 1, 0);
  for (std::size_t c = 0; c < 3 * triangles.size(); ++c) ++sorted.first[near(c) + 1];
  std::partial_sum(sorted.first.begin(), sorted.first.end(), sorted.first.begin());
  sorted.uses.resize(3 * triangles.size());
  std::vector<std::size_t> next = sorted.first;
  for (std::size_t c = 0; c < 3 * triangles.size(); ++c) {
    const int far = std::max(triangles[c / 3][c % 3], triangles[c / 3][(c + 1) % 3]);
    sorted.uses[next[near(c)]++] = {far, static_cast<int>(c)};
  }
  for (std::size_t v = 0; v + 1 < sorted.first.size(); ++v) {
    std::sort(sorted.uses.begin() + static_cast<std::ptrdiff_t>(sorted.first[v]),
              sorted.uses.begin() + static_cast<std::ptrdiff_t>(sorted.first[v + 1]));
  }
  return sorted;
}

}  // namespace

FaceLinks link_faces(std::span<const std::array<int, 3>> triangles) {
  FaceLinks links;
  links.beyond.assign(triangles.size() * 3, FaceLinks::kNone);
  const auto [first, uses] = sort_edge_uses(triangles);
  for (std::size_t v = 0; v + 1 < first.size(); ++v) {
    for (std::size_t from = first[v], to = from; from < first[v + 1]; from = to) {
      while (to < first[v + 1] && uses[to].far == uses[from].far) ++to;
      ++links.edges;
      if (to - from == 2) {
        links.beyond[static_cast<std::size_t>(uses[from].corner)] = uses[from + 1].corner;
        links.beyond[static_cast<std::size_t>(uses[from + 1].corner)] = uses[from].corner;
      } else if (to - from > 2 && links.crowded_edges++ == 0) {
        links.crowded_edge = {static_cast<int>(v), uses[from].far};
        links.crowded_edge_faces = to - from;
      }
    }
  }
  return links;
}

}  // namespace hotblade::surface
