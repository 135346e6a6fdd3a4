#include "gpu/triangle_distance.hpp"

#include <algorithm>
#include <limits>

namespace hotblade::gpu {
namespace {

using Eigen::Vector3d;

double inverse(double squared_length) {
  return squared_length > std::numeric_limits<double>::min() ? 1 / squared_length : 0;
}

}  // namespace

// The longest edge comes first: projecting on it keeps the error at rounding size for needles and caps.
TriangleDistance triangle_distance(const std::array<Vector3d, 3>& corners, const Vector3d& point) {
  const double l0 = (corners[1] - corners[0]).squaredNorm(), l1 = (corners[2] - corners[1]).squaredNorm(),
               l2 = (corners[0] - corners[2]).squaredNorm();
  std::size_t first = 0;
  if (l1 > l0 && l1 >= l2) {
    first = 1;
  } else if (l2 > l0) {
    first = 2;
  }
  const Vector3d& a = corners[first];
  const Vector3d e0 = corners[(first + 1) % 3] - a, e1 = corners[(first + 2) % 3] - a, r = point - a;
  const double inv_e0 = inverse(e0.squaredNorm()), along = r.dot(e0) * inv_e0, shear = e1.dot(e0) * inv_e0;
  const Vector3d h = e1 - shear * e0;
  const double inv_h = inverse(h.squaredNorm());
  const double v = (r - along * e0).dot(h) * inv_h, u = along - v * shear;
  if (inv_h > 0 && u >= 0 && v >= 0 && u + v <= 1) {
    const Vector3d offset = u * e0 + v * e1;
    return {(r - offset).squaredNorm(), a + offset};
  }
  const Vector3d e2 = e1 - e0;
  Vector3d nearest = std::clamp(along, 0.0, 1.0) * e0;
  double nearest_sq = (r - nearest).squaredNorm();
  for (const Vector3d& offset :
       {Vector3d(std::clamp(r.dot(e1) * inverse(e1.squaredNorm()), 0.0, 1.0) * e1),
        Vector3d(e0 + std::clamp((r - e0).dot(e2) * inverse(e2.squaredNorm()), 0.0, 1.0) * e2)}) {
    const double sq = (r - offset).squaredNorm();
    if (sq < nearest_sq) {
      nearest_sq = sq;
      nearest = offset;
    }
  }
  return {nearest_sq, a + nearest};
}

}  // namespace hotblade::gpu
