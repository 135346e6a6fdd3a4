#include "robot/pose/pose.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace hotblade::robot {

Eigen::Quaterniond canonical(const Eigen::Quaterniond& q) {
  const std::array c{q.w(), q.x(), q.y(), q.z()};
  std::size_t largest = 0;
  for (std::size_t i = 1; i < c.size(); ++i) {
    if (std::abs(c[i]) > std::abs(c[largest])) largest = i;
  }
  return std::signbit(c[largest]) ? Eigen::Quaterniond(-q.coeffs()) : q;
}

Pose transformed(const Pose& frame_to_other, const Pose& pose) {
  return {frame_to_other.q * pose.p + frame_to_other.p, frame_to_other.q * pose.q};
}

}  // namespace hotblade::robot
