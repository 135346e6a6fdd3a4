// Computes the distance of a point to a triangle in double precision: the one routine whose values reach a
// file, whichever backend searched.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>

namespace hotblade::gpu {

enum class Feature { kFace, kEdge, kVertex };

struct TriangleDistance {
  double distance_sq = 0;
  Eigen::Vector3d nearest{0, 0, 0};  // on the triangle
  Feature feature = Feature::kFace;  // what it lies on
  int corner = 0;                    // the vertex, or the edge from this corner to the next
};

// Returns an answer exact to a few roundings of the largest coordinate, for needles, caps, and triangles that
// are a segment or a point. The answer depends on the corners' order only in its last digits. It is inline,
// as it runs once or more for every point: the corners are read where they lie.
[[nodiscard]] inline TriangleDistance triangle_distance(const std::array<const Eigen::Vector3d*, 3>& corners,
                                                        const Eigen::Vector3d& point) {
  using Eigen::Vector3d;
  const auto inverse = [](double squared_length) {
    return squared_length > std::numeric_limits<double>::min() ? 1 / squared_length : 0.0;
  };
  // The longest edge comes first: projecting on it keeps the error at rounding size for needles and caps.
  const double l0 = (*corners[1] - *corners[0]).squaredNorm(), l1 = (*corners[2] - *corners[1]).squaredNorm(),
               l2 = (*corners[0] - *corners[2]).squaredNorm();
  std::size_t first = 0;
  if (l1 > l0 && l1 >= l2) {
    first = 1;
  } else if (l2 > l0) {
    first = 2;
  }
  const Vector3d& a = *corners[first];
  const Vector3d e0 = *corners[(first + 1) % 3] - a, e1 = *corners[(first + 2) % 3] - a, r = point - a;
  const double inv_e0 = inverse(e0.squaredNorm()), along = r.dot(e0) * inv_e0, shear = e1.dot(e0) * inv_e0;
  const Vector3d h = e1 - shear * e0;
  const double inv_h = inverse(h.squaredNorm());
  const double v = (r - along * e0).dot(h) * inv_h, u = along - v * shear;
  if (inv_h > 0 && u >= 0 && v >= 0 && u + v <= 1) {
    const Vector3d offset = u * e0 + v * e1;
    return {(r - offset).squaredNorm(), a + offset, Feature::kFace, 0};
  }
  const Vector3d e2 = e1 - e0;
  // Shares along the edges from the first corner to the second, to the third, and from the second to the
  // third.
  const std::array<double, 3> share{std::clamp(along, 0.0, 1.0),
                                    std::clamp(r.dot(e1) * inverse(e1.squaredNorm()), 0.0, 1.0),
                                    std::clamp((r - e0).dot(e2) * inverse(e2.squaredNorm()), 0.0, 1.0)};
  const std::array<Vector3d, 3> offset{share[0] * e0, share[1] * e1, e0 + share[2] * e2};
  std::size_t nearest = 0;
  double nearest_sq = (r - offset[0]).squaredNorm();
  for (std::size_t i = 1; i < 3; ++i) {
    const double sq = (r - offset[i]).squaredNorm();
    if (sq < nearest_sq) {
      nearest_sq = sq;
      nearest = i;
    }
  }
  constexpr std::size_t kFrom[] = {0, 0, 1}, kTo[] = {1, 2, 2}, kEdge[] = {0, 2, 1};
  std::size_t corner = kEdge[nearest];
  Feature feature = Feature::kEdge;
  if (!(share[nearest] > 0 && share[nearest] < 1)) {
    feature = Feature::kVertex;
    corner = share[nearest] > 0 ? kTo[nearest] : kFrom[nearest];
  }
  return {nearest_sq, a + offset[nearest], feature, static_cast<int>((first + corner) % 3)};
}

}  // namespace hotblade::gpu
