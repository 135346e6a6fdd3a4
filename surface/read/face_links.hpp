// Which face lies beyond each edge of each triangle, and the edges where that has no single answer.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hotblade::surface {

// Corner c = 3 f + i stands for corner i of face f and for its edge from corner i to corner i + 1 (mod 3).
struct FaceLinks {
  static constexpr int kNone = -1;
  std::vector<int> beyond;  // per corner: the corner that holds the same edge in the other face, or kNone
  std::size_t edges = 0;    // distinct
  std::size_t crowded_edges = 0;       // with more than two faces; their corners have no link
  std::array<int, 2> crowded_edge{};   // the first of them, as vertices
  std::size_t crowded_edge_faces = 0;  // and how many faces it has
};

[[nodiscard]] FaceLinks link_faces(std::span<const std::array<int, 3>> triangles);

// The two corners at the ends of corner c's edge: c itself and the next corner of its face.
[[nodiscard]] constexpr int next_corner(int c) {
  return c % 3 == 2 ? c - 2 : c + 1;
}

}  // namespace hotblade::surface
