#include "robot/pose/clamp_offset.hpp"

namespace hotblade::robot {

namespace {

Eigen::Vector3d as_vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

Eigen::Quaterniond turned_by(const std::array<double, 3>& turn_rad) {
  const Eigen::Vector3d turn = as_vector(turn_rad);
  const double angle = turn.norm();
  if (!(angle > 0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
}

}  // namespace

Pose held(const Pose& told, const ClampOffset& offset) {
  if (offset.none()) return told;
  return {told.p + told.q * as_vector(offset.shift_mm), (told.q * turned_by(offset.turn_rad)).normalized()};
}

Pose told(const Pose& held, const ClampOffset& offset) {
  if (offset.none()) return held;
  const Eigen::Quaterniond q = (held.q * turned_by(offset.turn_rad).conjugate()).normalized();
  return {held.p - q * as_vector(offset.shift_mm), q};
}

ClampPoses held(const ClampPoses& told, const ClampOffsets& offsets) {
  return {held(told.a, offsets.a), held(told.b, offsets.b)};
}

ClampPoses told(const ClampPoses& held, const ClampOffsets& offsets) {
  return {told(held.a, offsets.a), told(held.b, offsets.b)};
}

double reach_of(const ClampOffsets& offsets) {
  return as_vector(offsets.a.shift_mm).norm() + as_vector(offsets.b.shift_mm).norm();
}

}  // namespace hotblade::robot
