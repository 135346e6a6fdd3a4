#include "robot/pose/limits.hpp"

#include <algorithm>
#include <cmath>

#include "robot/pose/flat_arc.hpp"

namespace hotblade::robot {
namespace {

constexpr double kSqrt3 = 1.7320508075688772;
constexpr double kPositionStep_mm = 1e-3;  // register unit; rounding is half of it, twice in a difference
constexpr double kTimeStep_s = 1e-6;
// A decoded quaternion turns by at most 2 * sqrt(3) * 2^-30 for its three rounded components, and as much
// again for the derived one where it is no larger than they are; a difference of two doubles it.
constexpr double kAngleStep_rad = 4 * 2 * kSqrt3 / 1073741824.0;
// Doubles of a limit itself, as it went through a register.
constexpr double kRelative = 1e-9;

// Largest error of a speed over dt from rounding positions and times.
double linear_slack(double speed, double dt) {
  return kSqrt3 * kPositionStep_mm / dt + speed * kTimeStep_s / dt;
}
double angular_slack(double speed, double dt) {
  return kAngleStep_rad / dt + speed * kTimeStep_s / dt;
}

}  // namespace

Limit LimitChecker::next(const Waypoint& w) {
  if (const Limit place = check_place(w); place != Limit::kNone) return place;
  if (!started_) {
    if (const Limit first = check_first(w); first != Limit::kNone) return first;
    started_ = true;
    last_ = w;
    return Limit::kNone;
  }
  if (w.t_us <= last_.t_us) return Limit::kTime;
  // Both times are rounded, so a step of exactly the minimum may come out 1 us short.
  if (std::uint64_t{w.t_us - last_.t_us} + 1 < limits_.min_dt_us) return Limit::kMinDt;
  const double dt = (w.t_us - last_.t_us) * kTimeStep_s;
  const ClampRates va = rates_between(last_.a, w.a, dt), vb = rates_between(last_.b, w.b, dt);
  const double dt0 = last_dt_ > 0 ? last_dt_ : dt;
  for (const Limit code : {check_speed(va, dt), check_speed(vb, dt), check_change(va_, va, dt0, dt),
                           check_change(vb_, vb, dt0, dt)}) {
    if (code != Limit::kNone) return code;
  }
  last_ = w;
  va_ = va;
  vb_ = vb;
  last_dt_ = dt;
  return Limit::kNone;
}

Limit LimitChecker::finish() const {
  if (last_dt_ <= 0) return Limit::kNone;
  const Limit a = check_change(va_, {}, last_dt_, last_dt_);
  return a != Limit::kNone ? a : check_change(vb_, {}, last_dt_, last_dt_);
}

Limit LimitChecker::check_place(const Waypoint& w) const {
  const auto inside = [this](const Eigen::Vector3d& p) {
    return (p.array() >= limits_.envelope_min_mm.array()).all() &&
           (p.array() <= limits_.envelope_max_mm.array()).all();
  };
  if (!inside(w.a.p) || !inside(w.b.p)) return Limit::kEnvelope;
  // Two clamps rounded to whole micrometres on three axes move apart by at most sqrt(3) um.
  constexpr double kRounding_mm = 2e-3;
  const ClampPoses holding = held({w.a, w.b}, limits_.clamps);
  if ((holding.b.p - holding.a.p).norm() > blade_length_mm_ * (1 - limits_.chord_slack) + kRounding_mm)
    return Limit::kChord;
  return Limit::kNone;
}

Limit LimitChecker::check_first(const Waypoint& w) const {
  if (w.t_us != 0) return Limit::kTime;
  constexpr double kAngleSlack_rad = kFlatArcAngleSlack_rad;
  const auto [a, b] = held({w.a, w.b}, limits_.clamps);
  const Eigen::Vector3d chord = b.p - a.p;
  const double length = chord.norm();
  if (length <= 0) return Limit::kStartPose;
  const Eigen::Vector3d c = chord / length;
  const Eigen::Vector3d normal = a.q * Eigen::Vector3d::UnitZ();
  const auto turn = [&](const Pose& pose) {
    const Eigen::Vector3d tangent = pose.q * Eigen::Vector3d::UnitX();
    return std::atan2(normal.dot(c.cross(tangent)), c.dot(tangent));
  };
  const double ua = turn(a), ub = turn(b);
  const double out_of_plane =
      std::max(std::abs(c.dot(normal)), (normal - b.q * Eigen::Vector3d::UnitZ()).norm());
  const double u = (ua - ub) / 2, arc_chord = blade_length_mm_ * std::sin(u) / u;
  const bool flat = std::abs(ua + ub) <= 2 * kAngleSlack_rad && out_of_plane <= kAngleSlack_rad &&
                    std::abs(u) >= kFlatArcLeastHalfTurn_rad - kAngleSlack_rad &&
                    std::abs(u) <= kFlatArcMostHalfTurn_rad + kAngleSlack_rad &&
                    std::abs(length - arc_chord) <= kFlatArcChordSlack * blade_length_mm_;
  return flat ? Limit::kNone : Limit::kStartPose;
}

Limit LimitChecker::check_speed(const ClampRates& v, double dt) const {
  const double linear = v.linear.norm(), angular = v.angular.norm();
  if (linear > limits_.speed_mm_s * (1 + kRelative) + linear_slack(linear, dt)) return Limit::kSpeed;
  if (angular > limits_.angular_rad_s * (1 + kRelative) + angular_slack(angular, dt))
    return Limit::kAngularSpeed;
  return Limit::kNone;
}

Limit LimitChecker::check_change(const ClampRates& from, const ClampRates& to, double dt0, double dt1) const {
  const double mean_dt = (dt0 + dt1) / 2;
  const ClampAccelerations change = accelerations_between(from, to, dt0, dt1);
  const double linear_error =
      (linear_slack(from.linear.norm(), dt0) + linear_slack(to.linear.norm(), dt1)) / mean_dt;
  if (change.linear_mm_s2 > limits_.accel_mm_s2 * (1 + kRelative) + linear_error) return Limit::kAcceleration;
  const double angular_error =
      (angular_slack(from.angular.norm(), dt0) + angular_slack(to.angular.norm(), dt1)) / mean_dt;
  if (change.angular_rad_s2 > limits_.angular_accel_rad_s2 * (1 + kRelative) + angular_error)
    return Limit::kAngularAcceleration;
  return Limit::kNone;
}

}  // namespace hotblade::robot
