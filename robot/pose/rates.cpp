#include "robot/pose/rates.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace hotblade::robot {

namespace {

// Rotation from q0 to q1 by the shorter arc, as axis times angle in the axes both are given in.
Eigen::Vector3d rotation(const Eigen::Quaterniond& q0, const Eigen::Quaterniond& q1) {
  Eigen::Quaterniond d = q1 * q0.conjugate();
  if (d.w() < 0) d.coeffs() = -d.coeffs();
  const double s = d.vec().norm();
  const double angle = 2 * std::atan2(s, d.w());
  return s > 0 ? Eigen::Vector3d(d.vec() * (angle / s)) : Eigen::Vector3d::Zero();
}

}  // namespace

ClampRates rates_between(const Pose& from, const Pose& to, double dt_s) {
  return {(to.p - from.p) / dt_s, rotation(from.q, to.q) / dt_s};
}

ClampAccelerations accelerations_between(const ClampRates& from, const ClampRates& to, double dt0_s,
                                         double dt1_s) {
  const double mean_dt = (dt0_s + dt1_s) / 2;
  return {(to.linear - from.linear).norm() / mean_dt, (to.angular - from.angular).norm() / mean_dt};
}

}  // namespace hotblade::robot
