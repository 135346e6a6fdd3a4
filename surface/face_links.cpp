#include "surface/face_links.hpp"

#include <algorithm>

namespace hotblade::surface {
namespace {

struct EdgeUse {
  std::uint64_t vertices;  // the smaller one in the upper half
  int corner;
};

std::vector<EdgeUse> sorted_edge_uses(std::span<const std::array<int, 3>> triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(triangles.size() * 3);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(triangles[f][i], triangles[f][(i + 1) % 3]);
      uses.push_back({static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high),
                      static_cast<int>(3 * f + i)});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return a.vertices != b.vertices ? a.vertices < b.vertices : a.corner < b.corner;
  });
  return uses;
}

}  // namespace

FaceLinks link_faces(std::span<const std::array<int, 3>> triangles) {
  FaceLinks links;
  links.beyond.assign(triangles.size() * 3, FaceLinks::kNone);
  const std::vector<EdgeUse> uses = sorted_edge_uses(triangles);
  for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
    while (last < uses.size() && uses[last].vertices == uses[first].vertices) ++last;
    ++links.edges;
    if (last - first == 2) {
      links.beyond[static_cast<std::size_t>(uses[first].corner)] = uses[first + 1].corner;
      links.beyond[static_cast<std::size_t>(uses[first + 1].corner)] = uses[first].corner;
    } else if (last - first > 2 && links.crowded_edges++ == 0) {
      links.crowded_edge = {static_cast<int>(uses[first].vertices >> 32),
                            static_cast<int>(uses[first].vertices & 0xffffffffU)};
      links.crowded_edge_faces = last - first;
    }
  }
  return links;
}

}  // namespace hotblade::surface
