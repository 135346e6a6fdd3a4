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

constexpr float kSteps = 255;

// A 255th of a leaf's size, and the numbers so many of them over its lowest and under its highest.
float step_of(float low, float high) {
  return (high - low) / kSteps;
}
float above(float low, int steps, float step) {
  return low + static_cast<float>(steps) * step;
}
float below(float high, int steps, float step) {
  return high - static_cast<float>(steps) * step;
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
  pack_leaves(vertices, triangles);
  enclose();
  divide();
}

// By the boxes' middles along the curve (Morton 1966); faces of one cell of it keep their order.
void NearFaces::sort_faces(std::span<const Eigen::Vector3d> vertices,
                           std::span<const std::array<int, 3>> triangles) {
  Eigen::Vector3d low = vertices[static_cast<std::size_t>(triangles[0][0])], high = low;
  for (const auto& t : triangles) {
    for (const int v : t) {
      low = low.cwiseMin(vertices[static_cast<std::size_t>(v)]);
      high = high.cwiseMax(vertices[static_cast<std::size_t>(v)]);
    }
  }
  // Key and number of a face in one: what the number leaves free is shared by the axes.
  const int number_bits = static_cast<int>(std::bit_width(triangles.size())),
            axis_bits = std::min(21, (64 - number_bits) / 3);
  const auto cells = static_cast<double>((1 << axis_bits) - 1);
  const double extent = (high - low).maxCoeff(), scale = extent > 0 ? cells / extent : 0;
  std::vector<std::uint64_t> keys(triangles.size());
  for_blocks(keys.size(), kBlock, [&](std::size_t from, std::size_t to) {
    for (std::size_t f = from; f < to; ++f) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const int v : triangles[f]) sum += vertices[static_cast<std::size_t>(v)] - low;
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

void NearFaces::pack_leaves(std::span<const Eigen::Vector3d> vertices,
                            std::span<const std::array<int, 3>> triangles) {
  leaves_.resize(levels_[0].count);
  for_blocks(leaves_.size(), kBlock / kLeaf, [&](std::size_t from, std::size_t to) {
    std::array<Box, kLeaf> boxes{};
    for (std::size_t leaf = from; leaf < to; ++leaf) {
      const std::size_t first = leaf * kLeaf, count = std::min(kLeaf, faces_.size() - first);
      for (std::size_t i = 0; i < count; ++i)
        boxes[i] = box_of<Box>(vertices, triangles[static_cast<std::size_t>(faces_[first + i])]);
      pack_leaf(leaf, std::span<const Box>(boxes).first(count));
    }
  });
}

// A share is lowered until what it unpacks to holds the box: one of 0 is the leaf's own end, which does.
void NearFaces::pack_leaf(std::size_t leaf, std::span<const Box> boxes) {
  Box whole = boxes[0];
  for (const Box& box : boxes.subspan(1)) add(whole, box);
  nodes_[leaf] = whole;
  for (std::size_t k = 0; k < 3; ++k) {
    const float low = whole.low[k], high = whole.high[k], step = step_of(low, high);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const auto steps = [&](float way) {
        return step > 0 ? static_cast<int>(std::min(kSteps, way / step)) : 0;
      };
      int from = steps(boxes[i].low[k] - low), to = steps(high - boxes[i].high[k]);
      while (from > 0 && above(low, from, step) > boxes[i].low[k]) --from;
      while (to > 0 && below(high, to, step) < boxes[i].high[k]) --to;
      leaves_[leaf].low[k][i] = static_cast<std::uint8_t>(from);
      leaves_[leaf].high[k][i] = static_cast<std::uint8_t>(to);
    }
  }
}

// The faces that may meet a box. Bytes tell them from most others: a box begins beyond the end of `within`
// where its share is over that end's, and one step more leaves room for rounding.
void NearFaces::unpack(std::size_t leaf, const Box& within, Unpacked& some) const {
  using Bytes = std::uint8_t __attribute__((vector_size(kLeaf)));
  const Box& whole = nodes_[leaf];
  const LeafBoxes& packed = leaves_[leaf];
  std::array<float, 3> step{};
  auto apart = Bytes{} > Bytes{};
  for (std::size_t k = 0; k < 3; ++k) {
    step[k] = step_of(whole.low[k], whole.high[k]);
    if (!(step[k] > 0)) continue;
    const auto share = [&](float way) {
      return static_cast<std::uint8_t>(std::clamp(way / step[k] + 1, 0.0F, kSteps));
    };
    Bytes low, high;
    std::memcpy(&low, packed.low[k].data(), sizeof low);
    std::memcpy(&high, packed.high[k].data(), sizeof high);
    apart |= (low > share(within.high[k] - whole.low[k])) | (high > share(whole.high[k] - within.low[k]));
  }
  const std::size_t first = leaf * kLeaf, count = std::min(kLeaf, faces_.size() - first);
  some.count = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (apart[i] != 0) continue;
    Box& box = some.boxes[some.count];
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = above(whole.low[k], packed.low[k][i], step[k]);
      box.high[k] = below(whole.high[k], packed.high[k][i], step[k]);
    }
    some.faces[some.count++] = faces_[first + i];
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
  Unpacked own, others;
  unpack(leaf, nodes_[other], own);
  if (own.count == 0) return;
  if (leaf != other) unpack(other, nodes_[leaf], others);
  const Unpacked& with = leaf == other ? own : others;
  for (std::size_t i = 0; i < own.count; ++i) {
    for (std::size_t k = leaf == other ? i + 1 : 0; k < with.count; ++k) {
      if (overlap(own.boxes[i], with.boxes[k])) meet(own.faces[i], with.faces[k]);
    }
  }
}

}  // namespace hotblade::surface
