// The mesh that points are measured against in the benchmarks, and points near it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/bench/distance_peers.hpp"

namespace hotblade::bench {

// Of the shell over (x, y), mm.
inline double shell_height(double x, double y) {
  return 60 * std::sin(x / 130) * std::cos(y / 170);
}

// Returns a wavy square of about `count` triangles, 1000 mm wide.
inline PeerMesh wavy_shell(std::int64_t count) {
  PeerMesh s;
  const int n = static_cast<int>(std::sqrt(static_cast<double>(count) / 2));
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = 1000.0 * i / n, y = 1000.0 * j / n;
      s.vertices.push_back({x, y, shell_height(x, y)});
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, c = a + n + 1;
      s.triangles.push_back({a, c, c + 1});
      s.triangles.push_back({a, c + 1, a + 1});
    }
  }
  return s;
}

inline std::vector<Eigen::Vector3d> vectors(const std::vector<std::array<double, 3>>& points) {
  std::vector<Eigen::Vector3d> v;
  v.reserve(points.size());
  for (const auto& p : points) v.emplace_back(p[0], p[1], p[2]);
  return v;
}

// Ordered: a grid half a millimetre off the surface, row by row. Otherwise scattered as near as that, or
// (far) through the shell's box.
enum Order { kScattered = 0, kOrdered = 1, kFar = 2 };

// Returns the largest square number of points up to `count`.
inline std::vector<std::array<double, 3>> shell_points(std::int64_t order, std::int64_t count) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(0, 1000), z(-60, 60);
  const auto side = static_cast<std::int64_t>(std::sqrt(static_cast<double>(count)));
  std::vector<std::array<double, 3>> points;
  points.reserve(static_cast<std::size_t>(side * side));
  for (std::int64_t i = 0; i < side * side; ++i) {
    double x = 1000.0 * static_cast<double>(i / side) / static_cast<double>(side),
           y = 1000.0 * static_cast<double>(i % side) / static_cast<double>(side);
    if (order != kOrdered) {
      x = u(random);
      y = u(random);
    }
    points.push_back({x, y, order == kFar ? z(random) : shell_height(x, y) + 0.5});
  }
  return points;
}

}  // namespace hotblade::bench
