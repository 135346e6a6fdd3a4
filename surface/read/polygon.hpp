// Cuts one polygon of a mesh into triangles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace hotblade::surface {

// Appends a polygon's triangles to `triangles`: the polygon (corners are indices into `points`, no two
// neighbours equal, at least 3) is cut by ears in the plane of its Newell normal, a quad at the shorter
// diagonal that lies inside. Exact orientation tests make concave and nearly straight corners safe. Returns
// false when the outline crosses itself: what is left is then cut as a fan.
[[nodiscard]] bool triangulate_polygon(std::span<const Eigen::Vector3d> points, std::span<const int> corners,
                                       std::vector<std::array<int, 3>>& triangles);

}  // namespace hotblade::surface
