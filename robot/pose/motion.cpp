#include "robot/pose/motion.hpp"

#include <algorithm>
#include <cmath>

namespace hotblade::robot {

Pose interpolate(const Pose& from, const Pose& to, double share) {
  // Eigen's slerp takes the shorter arc.
  return {from.p + share * (to.p - from.p), from.q.slerp(share, to.q)};
}

ClampPoses interpolate(const ClampPoses& from, const ClampPoses& to, double share) {
  return {interpolate(from.a, to.a, share), interpolate(from.b, to.b, share)};
}

void PathClock::speed_up() {
  target_ = 1;
  if (instant_) rate_ = 1;
}

void PathClock::slow_down() {
  target_ = 0;
  if (instant_) rate_ = 0;
}

double PathClock::slope() const {
  if (rate_ < target_) return kRampPerS;
  return rate_ > target_ ? -kRampPerS : 0;
}

double PathClock::ramp_left_s() const {
  return rate_ == target_ ? std::numeric_limits<double>::infinity() : std::abs(target_ - rate_) / kRampPerS;
}

double PathClock::time_to_brake_for(double distance_s) const {
  if (instant_) return distance_s;
  // Up to the rate p and down again covers (p^2 - rate^2) / 2r + p^2 / 2r at a ramp of r.
  const double peak = std::sqrt(std::max(0.0, kRampPerS * distance_s + rate_ * rate_ / 2));
  if (peak <= 1) return std::max(0.0, (peak - rate_) / kRampPerS);
  const double ramp_path_s = (1 - rate_ * rate_) / (2 * kRampPerS);
  return (1 - rate_) / kRampPerS + distance_s - ramp_path_s - full_braking_s();
}

double PathClock::time_to(double distance_s) const {
  const double under_root = rate_ * rate_ + 2 * slope() * distance_s;
  if (under_root < 0) return std::numeric_limits<double>::infinity();
  const double divisor = rate_ + std::sqrt(under_root);
  return divisor > 0 ? 2 * distance_s / divisor : std::numeric_limits<double>::infinity();
}

void PathClock::advance(double dt_s) {
  const double a = slope();
  const bool ramp_ends = a != 0 && dt_s >= ramp_left_s();
  path_s_ += direction_ * (rate_ * dt_s + a * dt_s * dt_s / 2);
  rate_ = ramp_ends ? target_ : std::clamp(rate_ + a * dt_s, 0.0, 1.0);
}

}  // namespace hotblade::robot
