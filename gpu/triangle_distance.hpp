// Point to triangle in double precision: the one routine whose values reach a file, whichever backend
// searched.
#pragma once

#include <Eigen/Core>
#include <array>

namespace hotblade::gpu {

enum class Feature { kFace, kEdge, kVertex };

struct TriangleDistance {
  double distance_sq = 0;
  Eigen::Vector3d nearest{0, 0, 0};  // on the triangle
  Feature feature = Feature::kFace;  // what it lies on
  int corner = 0;                    // the vertex, or the edge from this corner to the next
};

// Exact to a few roundings of the largest coordinate, for needles, caps, and triangles that are a segment or
// a point. The answer depends on the corners' order only in its last digits.
[[nodiscard]] TriangleDistance triangle_distance(const std::array<Eigen::Vector3d, 3>& corners,
                                                 const Eigen::Vector3d& point);

}  // namespace hotblade::gpu
