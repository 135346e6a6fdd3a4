#include "pipeline/plan/motion/clamp_plane.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace hotblade::pipeline {

double off_plane_mm(const Pose& a, const Pose& b) {
  const Eigen::Quaterniond to_a = a.q.conjugate();
  const Eigen::Vector3d d = to_a * (b.p - a.p), normal = to_a * (b.q * Eigen::Vector3d::UnitZ());
  return std::max(std::abs(d.z()), d.norm() * normal.head<2>().norm());
}

double off_plane_mm(std::span<const BladePose> poses) {
  const auto middle = [](const Pose& p, const Pose& q) -> Pose {
    return {0.5 * (p.p + q.p), p.q.slerp(0.5, q.q)};
  };
  double worst = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const BladePose &p = poses[i - 1], &q = poses[i];
    const double off = off_plane_mm(middle(p.a, q.a), middle(p.b, q.b));
    if (!(off <= worst)) worst = off;  // a value that is not a number is told as well
  }
  return worst;
}

}  // namespace hotblade::pipeline
