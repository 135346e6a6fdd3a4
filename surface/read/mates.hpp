// Finds which triangle lies beyond each edge of a mesh that is a plain surface.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace hotblade::surface {

struct Mates {
  // For each corner (triangle_mesh.hpp) the one that holds the same edge in the triangle beyond it; -1 on the
  // border.
  std::vector<int> of_corner;
  // For each vertex its lowest corner; -1 without a triangle.
  std::vector<int> lowest;
};

// Returns what is across each edge. Nothing where the triangles are no plain surface: an edge has three of
// them or two that run the same way along it, or the triangles at a vertex do not hang together across edges.
// Each triangle needs three different ones of the vertices.
[[nodiscard]] std::optional<Mates> plain_mates(std::size_t vertices,
                                               std::span<const std::array<int, 3>> triangles);

}  // namespace hotblade::surface
