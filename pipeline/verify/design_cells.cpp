#include "pipeline/verify/design_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <stdexcept>
#include <unordered_map>
#include <utility>

namespace hotblade::pipeline {

namespace {

// One number for an edge between two points.
std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  const auto [low, high] = std::minmax(a, b);
  constexpr int kHalf = 32;
  return (static_cast<std::uint64_t>(low) << kHalf) | high;
}

}  // namespace

DesignCells::DesignCells(const MeshView& mesh) : points_(mesh.vertices.begin(), mesh.vertices.end()) {
  cells_.reserve(mesh.triangles.size());
  for (const std::array<int, 3>& t : mesh.triangles) {
    Cell cell;
    for (std::size_t i = 0; i < 3; ++i) cell.corners[i] = static_cast<std::uint32_t>(t[i]);
    cells_.push_back(cell);
  }
}

double DesignCells::area_mm2(const Cell& cell) const {
  return Facet{points_[cell.corners[0]], points_[cell.corners[1]], points_[cell.corners[2]]}.area();
}

double DesignCells::edge_mm(const Cell& cell, std::size_t edge) const {
  return (points_[cell.corners[(edge + 1) % 3]] - points_[cell.corners[edge]]).norm();
}

double DesignCells::longest_edge_mm(const Cell& cell) const {
  return edge_mm(cell, longest_edge(cell));
}

std::size_t DesignCells::longest_edge(const Cell& cell) const {
  const auto rank = [&](std::size_t i) {
    const std::uint32_t a = cell.corners[i], b = cell.corners[(i + 1) % 3];
    // Both cells at an edge take its difference the same way round, so that rounding is the same for both.
    const Eigen::Vector3d &low = points_[std::min(a, b)], &high = points_[std::max(a, b)];
    return std::pair((high - low).squaredNorm(), ~edge_key(a, b));
  };
  std::size_t longest = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    if (rank(i) > rank(longest)) longest = i;
  }
  return longest;
}

class DesignCells::Places {
 public:
  // Of a division of so many cells.
  Places(std::vector<Eigen::Vector3d>& points, std::size_t cells)
      : points_(points), pool_((cells + 1) * kRoom) {
    known_.reserve(cells);
  }

  // Returns the point `i` of `n` even pieces of the edge from a to b.
  std::uint32_t at(std::uint32_t a, std::uint32_t b, std::size_t i, std::size_t n) {
    if (i == 0 || i == n) return i == 0 ? a : b;
    const bool forth = a < b;
    const Key key{edge_key(a, b), static_cast<std::uint32_t>(forth ? i : n - i),
                  static_cast<std::uint32_t>(n)};
    const auto [found, is_new] = known_.try_emplace(key, static_cast<std::uint32_t>(points_.size()));
    if (!is_new) return found->second;
    const double share = static_cast<double>(key.place) / static_cast<double>(n);
    const Eigen::Vector3d from = points_[std::min(a, b)], to = points_[std::max(a, b)];
    points_.emplace_back(from + share * (to - from));
    return found->second;
  }

 private:
  struct Key {
    std::uint64_t edge;
    std::uint32_t place, pieces;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const noexcept {
      // Edges of one kind, row after row, take places one after another; those that have an end in common, or
      // lie across a strip, are spread by Fibonacci hashing.
      constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15, kHalf = 0xffffffff;
      const std::uint64_t low = key.edge >> 32, high = key.edge & kHalf, place = key.place,
                          pieces = key.pieces;
      return low + (((high - low) ^ (place << 40) ^ (pieces << 52)) * kGolden >> 16);
    }
  };
  // An entry of the table for each cell, and a place for every other, as most edges are two cells'; an eighth
  // to spare.
  static constexpr std::size_t kRoom = (sizeof(void*) + (sizeof(Key) + 2 * sizeof(void*)) / 2) * 9 / 8;

  std::vector<Eigen::Vector3d>& points_;
  std::pmr::monotonic_buffer_resource pool_;  // a million places are let go at once
  std::pmr::unordered_map<Key, std::uint32_t, Hash> known_{&pool_};
};

void DesignCells::halve(const Cell& cell, std::size_t longest, Places& places, std::vector<Cell>& parts) {
  const std::uint32_t a = cell.corners[longest], b = cell.corners[(longest + 1) % 3],
                      c = cell.corners[(longest + 2) % 3], middle = places.at(a, b, 1, 2);
  parts.push_back({{a, middle, c}});
  parts.push_back({{middle, b, c}});
}

// Between the tip and the shortest edge, across both long ones.
void DesignCells::slice(const Cell& cell, std::size_t shortest, std::size_t pieces, Places& places,
                        std::vector<Cell>& parts) {
  const std::uint32_t b = cell.corners[shortest], c = cell.corners[(shortest + 1) % 3],
                      tip = cell.corners[(shortest + 2) % 3];
  std::uint32_t left = tip, right = tip;
  for (std::size_t i = 1; i <= pieces; ++i) {
    const std::uint32_t next_left = places.at(tip, b, i, pieces), next_right = places.at(tip, c, i, pieces);
    parts.push_back({{left, next_left, next_right}});
    if (left != right) parts.push_back({{left, next_right, right}});
    left = next_left;
    right = next_right;
  }
}

std::vector<DesignCells::Cell> DesignCells::divide(std::span<const Cut> cuts) {
  if (cuts.size() != cells_.size()) throw std::logic_error("DesignCells::divide: one cut a cell");
  std::size_t divided = 0;
  for (const Cut& cut : cuts) divided += cut.pieces > 0 ? 1 : 0;
  std::vector<Cell> parts;
  parts.reserve(2 * divided);
  points_.reserve(points_.size() + divided);  // as many at most but for needles
  Places places(points_, divided);
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const Cut& cut = cuts[k];
    if (cut.pieces == 0) continue;
    if (cut.needle) {
      slice(cells_[k], cut.edge, cut.pieces, places, parts);
    } else {
      halve(cells_[k], cut.edge, places, parts);
    }
  }
  return std::exchange(cells_, std::move(parts));
}

DesignCells::Cut DesignCells::cut_to(const Cell& cell, double wanted_mm) const {
  constexpr double kNeedle = 0.25;  // shortest by longest edge
  const std::size_t longest = longest_edge(cell);
  std::size_t shortest = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    if (edge_mm(cell, i) < edge_mm(cell, shortest)) shortest = i;
  }
  const double long_mm = edge_mm(cell, longest);
  const bool needle = edge_mm(cell, shortest) < kNeedle * long_mm;
  const double pieces = std::max(2.0, std::ceil(long_mm / wanted_mm));
  constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
  return {static_cast<std::uint32_t>(std::min(pieces, kMost)),
          static_cast<std::uint8_t>(needle ? shortest : longest), needle};
}

}  // namespace hotblade::pipeline
