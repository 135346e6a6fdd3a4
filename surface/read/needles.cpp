#include "surface/read/needles.hpp"

#include <Eigen/Geometry>

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {
namespace {

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// The corner at the start of the longest edge.
int longest_edge(std::span<const Eigen::Vector3d> vertices, const std::array<int, 3>& t) {
  int best = 0;
  double longest = -1;
  for (int i = 0; i < 3; ++i) {
    const double length = (vertices[at(t[at(i)])] - vertices[at(t[at((i + 1) % 3)])]).squaredNorm();
    if (length > longest) {
      best = i;
      longest = length;
    }
  }
  return best;
}

// Gives the edge between the needle and its neighbour to their other two corners: both then have an area, or
// the neighbour is a needle too and another round follows.
void turn_edge(std::vector<std::array<int, 3>>& triangles, int needle_corner, int other_corner) {
  const int middle = triangles[at(needle_corner / 3)][at((needle_corner + 2) % 3)];
  auto& needle = triangles[at(needle_corner / 3)];
  auto& other = triangles[at(other_corner / 3)];
  const std::size_t i = at(other_corner % 3);
  const int x = other[i], y = other[(i + 1) % 3], far = other[(i + 2) % 3];
  needle = {x, middle, far};
  other = {middle, y, far};
}

}  // namespace

bool has_area(std::span<const Eigen::Vector3d> vertices, const std::array<int, 3>& t) {
  const Eigen::Vector3d a = vertices[at(t[1])] - vertices[at(t[0])],
                        b = vertices[at(t[2])] - vertices[at(t[0])];
  // Each component of the product is rounded by at most 2^-52 of |a| |b|: less is no area at all.
  constexpr double kRounding = 1e-15;
  return a.cross(b).norm() > kRounding * a.norm() * b.norm();
}

WithoutNeedles remove_needles(std::span<const Eigen::Vector3d> vertices,
                              std::vector<std::array<int, 3>> triangles, std::vector<std::uint32_t> line) {
  WithoutNeedles result;
  const auto is_needle = [&](std::size_t f) { return !has_area(vertices, triangles[f]); };
  std::vector<std::size_t> needles;
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (is_needle(f)) needles.push_back(f);
  }
  if (needles.empty()) return {std::move(triangles), std::move(line), 0};
  result.removed = needles.size();
  // A chain of needles on one line loses at least one a round; the limit ends rounds that turn in a circle.
  for (std::size_t round = 0; round <= result.removed && !needles.empty(); ++round) {
    const TriangleMesh mesh({{vertices.begin(), vertices.end()}, triangles});
    std::vector<bool> touched(triangles.size(), false);
    std::vector<std::size_t> left;
    for (const std::size_t f : needles) {
      const int corner = 3 * static_cast<int>(f) + longest_edge(vertices, triangles[f]);
      const int other = mesh.beyond(corner);
      if (touched[f] || (other != TriangleMesh::kNone && touched[at(other / 3)])) {
        left.push_back(f);
      } else if (other != TriangleMesh::kNone) {
        turn_edge(triangles, corner, other);
        touched[f] = touched[at(other / 3)] = true;
        if (is_needle(f)) left.push_back(f);
        if (is_needle(at(other / 3))) left.push_back(at(other / 3));
      }
    }
    if (left == needles) break;
    needles = std::move(left);
  }
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (is_needle(f)) continue;
    result.triangles.push_back(triangles[f]);
    result.line.push_back(line[f]);
  }
  return result;
}

}  // namespace hotblade::surface
