#include "surface/read/near_faces.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

namespace hotblade::surface {
namespace {

constexpr std::size_t kLeaf = 8;
// Top nodes that portions are made of: some dozens of portions for each core.
constexpr std::size_t kTopNodes = 64;

// Spreads the low 21 bits to every third place.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

float rounded_down(double x) {
  const auto y = static_cast<float>(x);
  return static_cast<double>(y) > x ? std::nextafter(y, -std::numeric_limits<float>::infinity()) : y;
}
float rounded_up(double x) {
  return -rounded_down(-x);
}

using Four = float __attribute__((vector_size(16)));

// Four numbers from here on: of a box's three, and the one that follows.
Four four(const float* from) {
  Four numbers;
  std::memcpy(&numbers, from, sizeof numbers);
  return numbers;
}

// Do they overlap? All axes at once, without a branch: most boxes that are compared do not. Reads one number
// past each box, and forgets it.
template <class Box>
bool overlap(const Box& a, const Box& b) {
  using Flags = int __attribute__((vector_size(16)));
  using Pair = long __attribute__((vector_size(16)));
  constexpr Flags kAxes{-1, -1, -1, 0};
  const Four a_low = four(a.low.data()), a_high = four(a.high.data());
  const Four b_low = four(b.low.data()), b_high = four(b.high.data());
  const auto apart = reinterpret_cast<Pair>(((a_low > b_high) | (b_low > a_high)) & kAxes);
  return (apart[0] | apart[1]) == 0;
}

template <class Box>
void add(Box& box, const Box& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = std::min(box.low[k], other.low[k]);
    box.high[k] = std::max(box.high[k], other.high[k]);
  }
}

template <class Box>
Box box_of(std::span<const Eigen::Vector3d> vertices, const std::array<int, 3>& t) {
  Box box{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto at = [&](std::size_t i) {
      return vertices[static_cast<std::size_t>(t[i])][static_cast<Eigen::Index>(k)];
    };
    box.low[k] = rounded_down(std::min({at(0), at(1), at(2)}));
    box.high[k] = rounded_up(std::max({at(0), at(1), at(2)}));
  }
  return box;
}

}  // namespace

NearFaces::NearFaces(std::span<const Eigen::Vector3d> vertices,
                     std::span<const std::array<int, 3>> triangles) {
  for (const auto& t : triangles) {
    for (const int v : t) {
      if (v < 0 || static_cast<std::size_t>(v) >= vertices.size())
        throw std::logic_error("NearFaces: vertex index out of range");
    }
  }
  if (triangles.empty()) return;
  sort_faces(vertices, triangles);
  grow_tree();
  divide();
}

// By the boxes' middles along the curve (Morton 1966); faces of one place keep their order.
void NearFaces::sort_faces(std::span<const Eigen::Vector3d> vertices,
                           std::span<const std::array<int, 3>> triangles) {
  Eigen::Vector3d low = vertices[static_cast<std::size_t>(triangles[0][0])], high = low;
  for (const auto& t : triangles) {
    for (const int v : t) {
      low = low.cwiseMin(vertices[static_cast<std::size_t>(v)]);
      high = high.cwiseMax(vertices[static_cast<std::size_t>(v)]);
    }
  }
  constexpr double kCells = (1 << 21) - 1;
  const double extent = (high - low).maxCoeff(), scale = extent > 0 ? kCells / extent : 0;
  std::vector<std::pair<std::uint64_t, int>> keys(triangles.size());
  tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t f) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int v : triangles[f]) sum += vertices[static_cast<std::size_t>(v)] - low;
    std::uint64_t key = 0;
    for (Eigen::Index k = 0; k < 3; ++k)
      key |= spread(static_cast<std::uint64_t>(std::clamp(sum[k] / 3 * scale, 0.0, kCells))) << k;
    keys[f] = {key, static_cast<int>(f)};
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  faces_.resize(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) faces_[i] = keys[i].second;
  std::vector<std::pair<std::uint64_t, int>>().swap(keys);  // as much as two thirds of the boxes
  boxes_.resize(faces_.size() + 1);
  tbb::parallel_for(std::size_t{0}, faces_.size(), [&](std::size_t i) {
    boxes_[i] = box_of<Box>(vertices, triangles[static_cast<std::size_t>(faces_[i])]);
  });
}

void NearFaces::grow_tree() {
  std::size_t total = 0;
  for (std::size_t count = (faces_.size() + kLeaf - 1) / kLeaf;; count = (count + 1) / 2) {
    levels_.push_back({total, count});
    total += count;
    if (count == 1) break;
  }
  nodes_.resize(total + 1);
  // The whole box of the items `first` to `last` of a list.
  const auto whole = [](const std::vector<Box>& items, std::size_t first, std::size_t last) {
    Box box = items[first];
    for (std::size_t i = first + 1; i < last; ++i) add(box, items[i]);
    return box;
  };
  for (std::size_t leaf = 0; leaf < levels_[0].count; ++leaf)
    nodes_[leaf] = whole(boxes_, leaf * kLeaf, std::min(faces_.size(), (leaf + 1) * kLeaf));
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    const auto [below, count_below] = levels_[level - 1];
    for (std::size_t i = 0; i < levels_[level].count; ++i)
      nodes_[levels_[level].first + i] =
          whole(nodes_, below + 2 * i, below + std::min(count_below, 2 * i + 2));
  }
}

void NearFaces::divide() {
  while (top_ + 1 < levels_.size() && levels_[top_].count > kTopNodes) ++top_;
  for (std::size_t a = 0; a < levels_[top_].count; ++a) {
    for (std::size_t b = a; b < levels_[top_].count; ++b) {
      if (meet_in(top_, a, b)) portions_.push_back({a, b});
    }
  }
}

bool NearFaces::meet_in(std::size_t level, std::size_t node, std::size_t other) const {
  const std::size_t first = levels_[level].first;
  return overlap(nodes_[first + node], nodes_[first + other]);
}

void NearFaces::visit(std::size_t portion, const Meet& meet) const {
  const auto [a, b] = portions_.at(portion);
  a == b ? within(top_, a, meet) : between(top_, a, b, meet);
}

void NearFaces::within(std::size_t level, std::size_t node, const Meet& meet) const {
  if (level == 0) return compare(node, node, meet);
  within(level - 1, 2 * node, meet);
  if (2 * node + 1 == levels_[level - 1].count) return;
  within(level - 1, 2 * node + 1, meet);
  between(level - 1, 2 * node, 2 * node + 1, meet);
}

void NearFaces::between(std::size_t level, std::size_t node, std::size_t other, const Meet& meet) const {
  if (!meet_in(level, node, other)) return;
  if (level == 0) return compare(node, other, meet);
  const std::size_t count = levels_[level - 1].count;
  for (std::size_t a = 2 * node; a < std::min(count, 2 * node + 2); ++a) {
    for (std::size_t b = 2 * other; b < std::min(count, 2 * other + 2); ++b) between(level - 1, a, b, meet);
  }
}

void NearFaces::compare(std::size_t leaf, std::size_t other, const Meet& meet) const {
  const auto end = [&](std::size_t of) { return std::min(faces_.size(), (of + 1) * kLeaf); };
  const Box& whole = nodes_[other];
  for (std::size_t i = leaf * kLeaf; i < end(leaf); ++i) {
    const Box& box = boxes_[i];
    if (!overlap(box, whole)) continue;
    for (std::size_t k = leaf == other ? i + 1 : other * kLeaf; k < end(other); ++k) {
      if (overlap(box, boxes_[k])) meet(faces_[i], faces_[k]);
    }
  }
}

}  // namespace hotblade::surface
