#include "surface/read/near_faces.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include "surface/read/blocks.hpp"

namespace hotblade::surface {
namespace {

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
  using Pairs = long __attribute__((vector_size(16)));
  using Flags = int __attribute__((vector_size(16)));
  constexpr Flags kAxes{-1, -1, -1, 0};
  const Four a_low = four(a.low.data()), a_high = four(a.high.data());
  const Four b_low = four(b.low.data()), b_high = four(b.high.data());
  const auto apart = reinterpret_cast<Pairs>(((a_low > b_high) | (b_low > a_high)) & kAxes);
  return (apart[0] | apart[1]) == 0;
}

template <class Box>
void add(Box& box, const Box& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = std::min(box.low[k], other.low[k]);
    box.high[k] = std::max(box.high[k], other.high[k]);
  }
}

}  // namespace

NearFaces::NearFaces(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<int, 3>> triangles)
    : vertices_(vertices), triangles_(triangles) {
  for_blocks(triangles.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t f = from; f < to; ++f) {
      for (const int v : triangles[f]) {
        if (v < 0 || static_cast<std::size_t>(v) >= vertices.size())
          throw std::logic_error("NearFaces: vertex index out of range");
      }
    }
  });
  if (triangles.empty()) return;
  sort_faces();
  grow_tree();
  enclose_leaves();
  enclose();
  divide();
}

// By the boxes' middles along the curve (Morton 1966); faces of one cell of it keep their order.
void NearFaces::sort_faces() {
  const auto at = [&](int v) -> const Eigen::Vector3d& { return vertices_[static_cast<std::size_t>(v)]; };
  using Bounds = std::array<Eigen::Vector3d, 2>;
  std::vector<Bounds> blocks((triangles_.size() + kBlock - 1) / kBlock);
  for_blocks(triangles_.size(), kBlock, [&](std::size_t from, std::size_t to) {
    Bounds own{at(triangles_[from][0]), at(triangles_[from][0])};
    for (std::size_t f = from; f < to; ++f)
      for (const int v : triangles_[f]) own = {own[0].cwiseMin(at(v)), own[1].cwiseMax(at(v))};
    blocks[from / kBlock] = own;
  });
  Eigen::Vector3d low = blocks[0][0], high = blocks[0][1];
  for (const Bounds& own : blocks) {
    low = low.cwiseMin(own[0]);
    high = high.cwiseMax(own[1]);
  }
  // Key and number of a face in one: what the number leaves free is shared by the axes.
  const int number_bits = static_cast<int>(std::bit_width(triangles_.size())),
            axis_bits = std::min(21, (64 - number_bits) / 3);
  const auto cells = static_cast<double>((1 << axis_bits) - 1);
  const double extent = (high - low).maxCoeff(), scale = extent > 0 ? cells / extent : 0;
  std::vector<std::uint64_t> keys(triangles_.size());
  for_blocks(keys.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t f = from; f < to; ++f) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const int v : triangles_[f]) sum += at(v) - low;
      std::uint64_t key = 0;
      for (Eigen::Index k = 0; k < 3; ++k)
        key |= spread(static_cast<std::uint64_t>(std::clamp(sum[k] / 3 * scale, 0.0, cells))) << k;
      keys[f] = key << number_bits | f;
    }
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  faces_.resize(keys.size());
  const std::uint64_t number = (std::uint64_t{1} << number_bits) - 1;
  for_blocks(keys.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) faces_[i] = static_cast<int>(keys[i] & number);
  });
}

NearFaces::Box NearFaces::box_of(std::span<const int> faces) const {
  const auto at = [&](int v) -> const Eigen::Vector3d& { return vertices_[static_cast<std::size_t>(v)]; };
  Eigen::Vector3d low = at(triangles_[static_cast<std::size_t>(faces[0])][0]), high = low;
  for (const int f : faces) {
    for (const int v : triangles_[static_cast<std::size_t>(f)]) {
      low = low.cwiseMin(at(v));
      high = high.cwiseMax(at(v));
    }
  }
  Box box{};
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = rounded_down(low[static_cast<Eigen::Index>(k)]);
    box.high[k] = rounded_up(high[static_cast<Eigen::Index>(k)]);
  }
  return box;
}

std::span<const int> NearFaces::faces_of(std::size_t leaf) const {
  const std::size_t first = leaf * kLeaf;
  return std::span(faces_).subspan(first, std::min(kLeaf, faces_.size() - first));
}

void NearFaces::enclose_leaves() {
  for_blocks(levels_[0].count, kBlock / kLeaf, [&](std::size_t from, std::size_t to) {
    for (std::size_t leaf = from; leaf < to; ++leaf) nodes_[leaf] = box_of(faces_of(leaf));
  });
}

void NearFaces::find(std::size_t leaf, const Box& within, Some& some) const {
  some.count = 0;
  for (const int& f : faces_of(leaf)) {
    some.boxes[some.count] = box_of({&f, 1});
    some.faces[some.count] = f;
    some.count += overlap(some.boxes[some.count], within) ? 1U : 0U;
  }
}

void NearFaces::grow_tree() {
  std::size_t total = 0;
  for (std::size_t count = (faces_.size() + kLeaf - 1) / kLeaf;; count = (count + 1) / 2) {
    levels_.push_back({total, count});
    total += count;
    if (count == 1) break;
  }
  nodes_.resize(total + 1);
}

void NearFaces::enclose() {
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    const auto [below_first, count_below] = levels_[level - 1];
    for (std::size_t i = 0; i < levels_[level].count; ++i) {
      Box& box = nodes_[levels_[level].first + i];
      box = nodes_[below_first + 2 * i];
      if (2 * i + 1 < count_below) add(box, nodes_[below_first + 2 * i + 1]);
    }
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

void NearFaces::leave_out(const std::function<bool(std::size_t, std::size_t)>& holds) {
  if (levels_.empty()) return;
  // A set's border grows with the root of its faces, and a surface turns away from an axis as it goes on.
  constexpr std::size_t kMostFaces = std::size_t{1} << 14;
  std::size_t level = 0;
  while (level < top_ && (kLeaf << (level + 1)) <= kMostFaces) ++level;
  left_out_.assign(nodes_.size(), 0);
  for_blocks(levels_[level].count, 1, [&](std::size_t node, std::size_t) { leave_out(level, node, holds); });
}

void NearFaces::leave_out(std::size_t level, std::size_t node, const Holds& holds) {
  // Fewer are compared as soon as their border is looked at.
  constexpr std::size_t kFewestFaces = 64;
  if (node >= levels_[level].count || (kLeaf << level) < kFewestFaces) return;
  const std::size_t first = (node * kLeaf) << level;
  if (holds(first, std::min(kLeaf << level, faces_.size() - first))) {
    left_out_[levels_[level].first + node] = 1;
    return;
  }
  leave_out(level - 1, 2 * node, holds);
  leave_out(level - 1, 2 * node + 1, holds);
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
  if (!left_out_.empty() && left_out_[levels_[level].first + node] != 0) return;
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
  Some own, others;
  find(leaf, nodes_[other], own);
  if (own.count == 0) return;
  if (leaf != other) find(other, nodes_[leaf], others);
  const Some& with = leaf == other ? own : others;
  for (std::size_t i = 0; i < own.count; ++i) {
    for (std::size_t k = leaf == other ? i + 1 : 0; k < with.count; ++k) {
      if (overlap(own.boxes[i], with.boxes[k])) meet(own.faces[i], with.faces[k]);
    }
  }
}

}  // namespace hotblade::surface
