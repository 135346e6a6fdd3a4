#include "surface/read/needles.hpp"

#include <Eigen/Geometry>
#include <utility>

#include "surface/read/blocks.hpp"
#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {
namespace {

std::size_t place(int i) {
  return static_cast<std::size_t>(i);
}

// The corner at the start of the longest edge.
int longest_edge(std::span<const Eigen::Vector3d> vertices, const std::array<int, 3>& t) {
  int best = 0;
  double longest = -1;
  for (int i = 0; i < 3; ++i) {
    const double length =
        (vertices[place(t[place(i)])] - vertices[place(t[place((i + 1) % 3)])]).squaredNorm();
    if (length > longest) {
      best = i;
      longest = length;
    }
  }
  return best;
}

// Gives the edge between the needle and its neighbour to their other two corners: both then have an area, or
// the neighbour is a needle too and another round follows. False, and nothing done, where both have the same
// three corners: the needles lie folded on each other.
bool turn_edge(std::vector<std::array<int, 3>>& triangles, int needle_corner, int other_corner) {
  const int middle = triangles[place(needle_corner / 3)][place((needle_corner + 2) % 3)];
  auto& needle = triangles[place(needle_corner / 3)];
  auto& other = triangles[place(other_corner / 3)];
  const std::size_t i = place(other_corner % 3);
  const int x = other[i], y = other[(i + 1) % 3], far = other[(i + 2) % 3];
  if (middle == far) return false;
  needle = {x, middle, far};
  other = {middle, y, far};
  return true;
}

// Triangles with the lines they came from, and which of them have no area.
class Needles {
 public:
  Needles(std::span<const Eigen::Vector3d> vertices, std::vector<std::array<int, 3>> triangles,
          std::vector<std::uint32_t> line)
      : vertices_(vertices), triangles_(std::move(triangles)), line_(std::move(line)) {
    find();
  }

  [[nodiscard]] std::size_t count() const { return needles_.size(); }

  // Turns the longest edge of every needle, or takes it out with one that it lies folded on, which leaves no
  // gap: what was beside the one is then beside the other. Returns whether anything came of it.
  bool round() {
    const TriangleMesh mesh({{vertices_.begin(), vertices_.end()}, triangles_});
    std::vector<bool> touched(triangles_.size(), false), folded(triangles_.size(), false);
    std::vector<std::size_t> left;
    bool any_folded = false;
    for (const std::size_t f : needles_) {
      const int corner = 3 * static_cast<int>(f) + longest_edge(vertices_, triangles_[f]);
      const int other = mesh.beyond(corner);
      if (touched[f] || (other != TriangleMesh::kNone && touched[place(other / 3)])) {
        left.push_back(f);
      } else if (other != TriangleMesh::kNone) {
        const std::size_t beyond = place(other / 3);
        touched[f] = touched[beyond] = true;
        if (!turn_edge(triangles_, corner, other)) {
          any_folded = folded[f] = folded[beyond] = true;
          continue;
        }
        if (is_needle(f)) left.push_back(f);
        if (is_needle(beyond)) left.push_back(beyond);
      }
    }
    if (any_folded) {
      drop(folded);
      find();
      return true;
    }
    const bool changed = left != needles_;
    needles_ = std::move(left);
    return changed;
  }

  // Takes out the needles that are left.
  void drop_all() {
    std::vector<bool> dropped(triangles_.size());
    for (std::size_t f = 0; f < triangles_.size(); ++f) dropped[f] = is_needle(f);
    drop(dropped);
  }

  [[nodiscard]] std::vector<std::array<int, 3>> take_triangles() { return std::move(triangles_); }
  [[nodiscard]] std::vector<std::uint32_t> take_lines() { return std::move(line_); }

 private:
  [[nodiscard]] bool is_needle(std::size_t f) const { return !has_area(vertices_, triangles_[f]); }

  void find() {
    needles_.clear();
    std::vector<std::vector<std::size_t>> found((triangles_.size() + kBlock - 1) / kBlock);
    for_blocks(triangles_.size(), kBlock, [&](std::size_t from, std::size_t to) {
      for (std::size_t f = from; f < to; ++f)
        if (is_needle(f)) found[from / kBlock].push_back(f);
    });
    for (const auto& own : found) needles_.insert(needles_.end(), own.begin(), own.end());
  }

  void drop(const std::vector<bool>& dropped) {
    std::size_t kept = 0;
    for (std::size_t f = 0; f < triangles_.size(); ++f) {
      if (dropped[f]) continue;
      triangles_[kept] = triangles_[f];
      line_[kept++] = line_[f];
    }
    triangles_.resize(kept);
    line_.resize(kept);
  }

  std::span<const Eigen::Vector3d> vertices_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<std::uint32_t> line_;
  std::vector<std::size_t> needles_;
};

}  // namespace

bool has_area(std::span<const Eigen::Vector3d> vertices, const std::array<int, 3>& t) {
  const Eigen::Vector3d a = vertices[place(t[1])] - vertices[place(t[0])],
                        b = vertices[place(t[2])] - vertices[place(t[0])];
  // Each component of the product is rounded by at most 2^-52 of |a| |b|: less is no area at all.
  constexpr double kRounding = 1e-15;
  return a.cross(b).norm() > kRounding * a.norm() * b.norm();
}

WithoutNeedles remove_needles(std::span<const Eigen::Vector3d> vertices,
                              std::vector<std::array<int, 3>> triangles, std::vector<std::uint32_t> line) {
  Needles needles(vertices, std::move(triangles), std::move(line));
  const std::size_t removed = needles.count();
  // A chain of needles on one line loses at least one a round; the limit ends rounds that turn in a circle.
  for (std::size_t round = 0; round <= removed && needles.count() > 0; ++round) {
    if (!needles.round()) break;
  }
  if (removed > 0) needles.drop_all();
  return {needles.take_triangles(), needles.take_lines(), removed};
}

}  // namespace hotblade::surface
