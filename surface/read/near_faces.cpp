#include "surface/read/near_faces.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace hotblade::surface {
namespace {

constexpr std::size_t kLeaf = 4;
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

}  // namespace

// All axes at once, without a branch: most boxes that are compared do not meet.
bool NearFaces::Box::meets(const Box& other) const {
  using Pair = long __attribute__((vector_size(16)));
  const auto apart = reinterpret_cast<Pair>((low > other.high) | (other.low > high));
  return (apart[0] | apart[1]) == 0;
}

void NearFaces::Box::add(const Box& other) {
  low = low < other.low ? low : other.low;
  high = high > other.high ? high : other.high;
}

NearFaces::NearFaces(const TriangleMesh& mesh) {
  for (const auto& t : mesh.triangles) {
    for (const int v : t) {
      if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices.size())
        throw std::logic_error("NearFaces: vertex index out of range");
    }
  }
  if (mesh.triangles.empty()) return;
  sort_faces(mesh);
  grow_tree();
  divide();
}

NearFaces::Box NearFaces::box_of(const TriangleMesh& mesh, std::size_t face) const {
  const auto& t = mesh.triangles[face];
  Box box{};
  for (int k = 0; k < 3; ++k) {
    const auto at = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(t[i])][k]; };
    box.low[k] = rounded_down(std::min({at(0), at(1), at(2)}));
    box.high[k] = rounded_up(std::max({at(0), at(1), at(2)}));
  }
  return box;
}

// By the boxes' middles along the curve (Morton 1966); faces of one place keep their order.
void NearFaces::sort_faces(const TriangleMesh& mesh) {
  Eigen::Vector3d low = mesh.vertices[static_cast<std::size_t>(mesh.triangles[0][0])], high = low;
  for (const auto& t : mesh.triangles) {
    for (const int v : t) {
      low = low.cwiseMin(mesh.vertices[static_cast<std::size_t>(v)]);
      high = high.cwiseMax(mesh.vertices[static_cast<std::size_t>(v)]);
    }
  }
  constexpr double kCells = (1 << 21) - 1;
  const double extent = (high - low).maxCoeff(), scale = extent > 0 ? kCells / extent : 0;
  std::vector<std::pair<std::uint64_t, int>> keys(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t f) {
    const auto& t = mesh.triangles[f];
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int v : t) sum += mesh.vertices[static_cast<std::size_t>(v)] - low;
    std::uint64_t key = 0;
    for (Eigen::Index k = 0; k < 3; ++k)
      key |= spread(static_cast<std::uint64_t>(std::clamp(sum[k] / 3 * scale, 0.0, kCells))) << k;
    keys[f] = {key, static_cast<int>(f)};
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  faces_.resize(keys.size());
  boxes_.resize(keys.size());
  tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t i) {
    faces_[i] = keys[i].second;
    boxes_[i] = box_of(mesh, static_cast<std::size_t>(keys[i].second));
  });
}

void NearFaces::grow_tree() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr Box kEmpty{{kInfinity, kInfinity, kInfinity, 0}, {-kInfinity, -kInfinity, -kInfinity, 0}};
  leaves_ = std::bit_ceil((faces_.size() + kLeaf - 1) / kLeaf);
  nodes_.assign(2 * leaves_, kEmpty);
  for (std::size_t i = 0; i < boxes_.size(); ++i) nodes_[leaves_ + i / kLeaf].add(boxes_[i]);
  for (std::size_t node = leaves_ - 1; node > 0; --node) {
    nodes_[node] = nodes_[2 * node];
    nodes_[node].add(nodes_[2 * node + 1]);
  }
}

void NearFaces::divide() {
  const std::size_t top = std::min(kTopNodes, leaves_);
  for (std::size_t a = top; a < 2 * top; ++a) {
    for (std::size_t b = a; b < 2 * top; ++b) {
      if (nodes_[a].meets(nodes_[b])) portions_.push_back({a, b});
    }
  }
}

void NearFaces::visit(std::size_t portion, const Meet& meet) const {
  const auto [a, b] = portions_.at(portion);
  a == b ? within(a, meet) : between(a, b, meet);
}

void NearFaces::within(std::size_t node, const Meet& meet) const {
  if (node >= leaves_) return compare(node - leaves_, node - leaves_, meet);
  within(2 * node, meet);
  within(2 * node + 1, meet);
  between(2 * node, 2 * node + 1, meet);
}

// Both of one level.
void NearFaces::between(std::size_t node, std::size_t other, const Meet& meet) const {
  if (!nodes_[node].meets(nodes_[other])) return;
  if (node >= leaves_) return compare(node - leaves_, other - leaves_, meet);
  for (const std::size_t a : {2 * node, 2 * node + 1}) {
    for (const std::size_t b : {2 * other, 2 * other + 1}) between(a, b, meet);
  }
}

void NearFaces::compare(std::size_t leaf, std::size_t other, const Meet& meet) const {
  const auto end = [&](std::size_t of) { return std::min(faces_.size(), (of + 1) * kLeaf); };
  const Box& whole = nodes_[leaves_ + other];
  for (std::size_t i = leaf * kLeaf; i < end(leaf); ++i) {
    const Box& box = boxes_[i];
    if (!box.meets(whole)) continue;
    for (std::size_t k = leaf == other ? i + 1 : other * kLeaf; k < end(other); ++k) {
      if (box.meets(boxes_[k])) meet(faces_[i], faces_[k]);
    }
  }
}

}  // namespace hotblade::surface
