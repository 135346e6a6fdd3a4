// Gives the double-precision distance of a point to a triangle (kernels/triangle_exact.h) in the host's
// types.
#pragma once

#include <Eigen/Core>
#include <array>

#include "gpu/kernels/triangle_exact.h"

namespace hotblade::gpu {

enum class Feature { kFace, kEdge, kVertex };

struct TriangleDistance {
  double distance_sq = 0;
  Eigen::Vector3d nearest{0, 0, 0};  // on the triangle
  Feature feature = Feature::kFace;  // what it lies on
  int corner = 0;                    // the vertex, or the edge from this corner to the next
};

// Returns the answer of hb_nearest_of_triangle. It is inline, as it runs once or more for every point: the
// corners are read where they lie.
[[nodiscard]] inline TriangleDistance triangle_distance(const std::array<const Eigen::Vector3d*, 3>& corners,
                                                        const Eigen::Vector3d& point) {
  const auto plain = [](const Eigen::Vector3d& v) { return hb_vec3{v.x(), v.y(), v.z()}; };
  const hb_triangle_foot foot =
      hb_nearest_of_triangle(plain(*corners[0]), plain(*corners[1]), plain(*corners[2]), plain(point));
  return {foot.distance_sq, {foot.x, foot.y, foot.z}, static_cast<Feature>(foot.feature), foot.corner};
}

}  // namespace hotblade::gpu
