#include "robot/controller/arm_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robot/pose/motion.hpp"

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using protocol::ArmsDetail;
using protocol::ArmsOther;

constexpr double kSample_s = 0.01, kMicrosecond_s = 1e-6;
// Half a count on three axes, and what a decoded quaternion turns by at most (robot/pose/limits.cpp).
constexpr double kRounding_mm = 0.866e-3, kRounding_rad = 6.5e-9;
// Third differences of whole micrometres say 55 mm/s^3 over steps of 50 ms, and 55,000 over steps of 5 ms.
constexpr double kJerkStep_s = 0.04;
// Doubles of a limit itself.
constexpr double kRelative = 1e-9;
// Farther than an arm of this reach a turn of the shoulder or elbow does not carry the wrist.
constexpr double kReach_mm = 3000;
// In 10 ms no joint goes so far: it would be another solution.
constexpr double kJump_rad = 0.5;

std::int32_t counted(double amount, double counts) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::clamp(std::round(amount * counts), -kMost, kMost));
}
constexpr double kMillionths = 1e6, kThousandths = 1e3;

Breach breach(Limit limit, std::uint8_t arm, std::size_t part, double amount, double counts) {
  return {limit, {arm, static_cast<std::uint8_t>(part), ArmsOther::kNothing, 0, counted(amount, counts)}};
}

// One jaw serves both clamps: at clamp B it is turned by half a turn about the plane's normal, flipped by
// half a turn about the way the blade leaves.
Isometry3d jaw_at(const Pose& clamp, bool clamp_b, bool flip) {
  Isometry3d jaw = isometry(clamp);
  if (clamp_b) jaw.linear() = jaw.linear() * Vector3d(-1, -1, 1).asDiagonal();
  if (flip) jaw.linear() = jaw.linear() * Vector3d(1, -1, -1).asDiagonal();
  return jaw;
}

JointAngles angles(const std::array<double, protocol::kArmJoints>& q) {
  return Eigen::Map<const JointAngles>(q.data());
}

// The third derivative by four places at four times, and how far errors of the places may be in it.
template <class Value>
Value third_derivative(const std::array<double, 4>& t, const std::array<Value, 4>& f) {
  Value sum = Value::Zero();
  for (std::size_t m = 0; m < 4; ++m) {
    double product = 1;
    for (std::size_t n = 0; n < 4; ++n) product *= n == m ? 1 : t[m] - t[n];
    sum += 6 / product * f[m];
  }
  return sum;
}
template <class Value>
Value third_derivative_error(const std::array<double, 4>& t, const std::array<Value, 4>& error) {
  Value sum = Value::Zero();
  for (std::size_t m = 0; m < 4; ++m) {
    double product = 1;
    for (std::size_t n = 0; n < 4; ++n) product *= n == m ? 1 : std::abs(t[m] - t[n]);
    sum += 6 / product * error[m];
  }
  return sum;
}

}  // namespace

ArmCheck::ArmCheck(std::shared_ptr<const ArmCell> cell, const protocol::Arms& declared, std::uint64_t job,
                   double blade_width_mm, const ClampOffset& clamp_a)
    : cell_(std::move(cell)), declared_(declared), watch_(*cell_, job, blade_width_mm), clamp_a_(clamp_a) {
  fits_ = declared.cell_id == cell_->id();
}

std::optional<bool> ArmCheck::jaw_flipped(std::size_t clamp, const Pose& pose) const {
  const ArmPosture posture = posture_of(arm_at(clamp), angles(declared_.joints_rad[clamp]));
  for (const bool flip : {false, true}) {
    if (flip && !arm_at(clamp).tool.flip) continue;
    const JawOff left = off(posture, jaw_at(pose, clamp == 1, flip));
    if (left.way_mm.norm() <= kDeclaredOff_mm && left.turn_rad.norm() <= kDeclaredOff_rad) return flip;
  }
  return std::nullopt;
}

// Which arm holds which clamp follows from the joints: they hold it with one arm only.
bool ArmCheck::begin(const Pose& a, const Pose& b) {
  begun_ = true;
  for (const std::size_t at_a : {0, 1}) {
    arm_ = {at_a, 1 - at_a};
    const std::optional<bool> flip_a = jaw_flipped(0, a), flip_b = jaw_flipped(1, b);
    if (!flip_a || !flip_b) continue;
    flip_ = {*flip_a, *flip_b};
    for (const std::size_t clamp : {0, 1}) {
      posture_[clamp] = posture_of(arm_at(clamp), angles(declared_.joints_rad[clamp]));
      first_[clamp] = bends_of(posture_[clamp]);
    }
    return true;
  }
  return false;
}

Isometry3d ArmCheck::jaw_for(std::size_t clamp, const Pose& pose) const {
  return jaw_at(pose, clamp == 1, flip_[clamp]);
}

Breach ArmCheck::follow_clamp(std::size_t clamp, const Pose& pose, double step_s) {
  const FollowedJoints followed = follow(arm_at(clamp), posture_[clamp].q, jaw_for(clamp, pose));
  if (!followed.there) return not_there(clamp, followed);
  const JointAngles way = followed.q - posture_[clamp].q;
  posture_[clamp] = posture_of(arm_at(clamp), followed.q);
  const ArmBends now = bends_of(posture_[clamp]), &first = first_[clamp];
  const auto turned = [](double a, double b) { return std::signbit(a) != std::signbit(b); };
  const bool jumps = way.cwiseAbs().maxCoeff() > kJump_rad;
  if (turned(now.wrist_rad, first.wrist_rad) || jumps)
    return breach(Limit::kConfiguration, number(clamp), 5, 0, kMillionths);
  if (turned(now.elbow_rad, first.elbow_rad))
    return breach(Limit::kConfiguration, number(clamp), 3, 0, kMillionths);
  if (turned(now.shoulder_mm, first.shoulder_mm))
    return breach(Limit::kConfiguration, number(clamp), 1, 0, kThousandths);
  const Breach angle = check_angles(clamp, step_s);
  return angle.limit != Limit::kNone ? angle : check_bends(clamp, step_s);
}

// Where an arm falls short it does so stretched. Next to another singular place it gets there but for
// rounding, and would have to turn about itself.
Breach ArmCheck::not_there(std::size_t clamp, const FollowedJoints& followed) const {
  const ArmBends bends = bends_of(posture_of(arm_at(clamp), followed.q));
  const double wrist = std::abs(bends.wrist_rad), elbow = std::abs(bends.elbow_rad),
               shoulder = std::abs(bends.shoulder_mm) / kReach_mm;
  if (elbow < std::min(wrist, shoulder))
    return breach(Limit::kArmReach, number(clamp), 0, followed.short_mm, kThousandths);
  return breach(Limit::kConfiguration, number(clamp), wrist < shoulder ? 5 : 1, 0, kMillionths);
}

// Between waypoints clamps move in straight lines and joints do not: with an acceleration of a they leave the
// line by a h^2 / 8 at most.
Breach ArmCheck::check_angles(std::size_t clamp, double step_s) const {
  const CellArm& arm = arm_at(clamp);
  const double kept = cell_->cell().margins.joint_deg * kDegree_rad;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Joint& joint = arm.model.arm.joints()[i];
    const double q = posture_[clamp].q[static_cast<int>(i)];
    const double over = kept - std::min(q - joint.min_rad, joint.max_rad - q);
    const double bulge = arm.acceleration_rad_s2[i] * step_s * step_s / 8 + kMicrosecond_s;
    if (over > bulge) return breach(Limit::kJointAngle, number(clamp), i + 1, over, kMillionths);
  }
  return {};
}

Breach ArmCheck::check_bends(std::size_t clamp, double step_s) const {
  const ArmBends bends = bends_of(posture_[clamp]);
  const ArmMargins& least = cell_->cell().margins;
  const auto& accel = arm_at(clamp).acceleration_rad_s2;
  const double by = step_s * step_s / 8;
  const double wrist = least.wrist_deg * kDegree_rad - std::abs(bends.wrist_rad);
  if (wrist > accel[4] * by + kMicrosecond_s)
    return breach(Limit::kNearSingular, number(clamp), 5, wrist, kMillionths);
  const double elbow = least.elbow_deg * kDegree_rad - std::abs(bends.elbow_rad);
  if (elbow > accel[2] * by + kMicrosecond_s)
    return breach(Limit::kNearSingular, number(clamp), 3, elbow, kMillionths);
  const double shoulder = least.shoulder_mm - std::abs(bends.shoulder_mm);
  if (shoulder > kReach_mm * ((accel[1] + accel[2]) * by + kMicrosecond_s))
    return breach(Limit::kNearSingular, number(clamp), 1, shoulder, kThousandths);
  return {};
}

Breach ArmCheck::move_to(const Pose& a, const Pose& b, const Blade& blade, double step_s) {
  if (!checks() || !fits_) return {};
  if (!begun_ && !begin(a, b)) fits_ = false;
  if (!fits_) return {};
  for (const std::size_t clamp : {0, 1}) {
    if (const Breach found = follow_clamp(clamp, clamp == 0 ? a : b, step_s); found.limit != Limit::kNone)
      return found;
  }
  std::array<ArmPosture, 2> arms;
  for (const std::size_t clamp : {0, 1}) arms[arm_[clamp]] = posture_[clamp];
  // The jaws stand at the poses that were told; the blade begins where clamp A holds it.
  const Pose blade_from = held(a, clamp_a_);
  std::optional<ArmWatch::BladeNow> now;
  if (blade) now.emplace(ArmWatch::BladeNow{*blade, blade_from, arm_[0]});
  const auto near = watch_.look(*cell_, arms, now);
  return near ? Breach{Limit::kArmClearance, near->detail} : Breach{};
}

Breach ArmCheck::next(const Waypoint& w, const Blade& blade) {
  if (!checks() || !fits_) return {};
  if (last_) {
    const double step_s = (w.t_us - last_->t_us) * kMicrosecond_s;
    const auto samples = static_cast<int>(std::ceil(step_s / kSample_s));
    for (int i = 1; i < samples; ++i) {
      const double share = static_cast<double>(i) / samples;
      const Breach between =
          move_to(interpolate(last_->a, w.a, share), interpolate(last_->b, w.b, share), std::nullopt, step_s);
      if (between.limit != Limit::kNone) return between;
    }
  }
  return arrive(w, blade);
}

Breach ArmCheck::arrive(const Waypoint& w, const Blade& blade) {
  if (!checks() || !fits_) return {};
  const double step_s = last_ ? (w.t_us - last_->t_us) * kMicrosecond_s : 0;
  const Breach place = move_to(w.a, w.b, blade, step_s);
  if (place.limit != Limit::kNone || !fits_) return place;
  const Met now = met(w);
  const Breach rates = check_rates(now);
  last_ = w;
  met_ = now;
  return rates;
}

ArmCheck::Met ArmCheck::met(const Waypoint& w) const {
  Met now;
  now.t = w.t_us * kMicrosecond_s;
  for (const std::size_t clamp : {0, 1}) {
    now.q[clamp] = posture_[clamp].q;
    now.rounding[clamp] = turned_by_rounding(posture_[clamp], kRounding_mm, kRounding_rad);
    const Pose& pose = clamp == 0 ? w.a : w.b;
    now.place[clamp] = pose.p;
    now.turned[clamp].setZero();
    if (met_) {
      const Pose& before = clamp == 0 ? last_->a : last_->b;
      now.turned[clamp] = met_->turned[clamp] + rates_between(before, pose, 1).angular;
    }
  }
  return now;
}

// Speeds over the step to a waypoint, accelerations at its start, jerk over the last four that are far
// enough apart.
Breach ArmCheck::check_rates(const Met& now) {
  if (!met_) return note_for_jerk(now);
  const double dt = now.t - met_->t;
  std::array<JointAngles, 2> speed, error;
  for (const std::size_t clamp : {0, 1}) {
    const CellArm& arm = arm_at(clamp);
    speed[clamp] = (now.q[clamp] - met_->q[clamp]) / dt;
    error[clamp] =
        (now.rounding[clamp] + met_->rounding[clamp] + speed[clamp].cwiseAbs() * kMicrosecond_s) / dt;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto k = static_cast<int>(i);
      const double most = arm.speed_share * arm.model.arm.joints()[i].speed_rad_s;
      const double over = std::abs(speed[clamp][k]) - most;
      if (over > kRelative * most + error[clamp][k])
        return breach(Limit::kJointSpeed, number(clamp), i + 1, over, kMillionths);
    }
  }
  if (step_s_ <= 0) {
    step_s_ = dt;
    for (const std::size_t clamp : {0, 1}) speed_[clamp] = speed_error_[clamp] = JointAngles::Zero();
  }
  if (const Breach change = check_change(speed, error, dt); change.limit != Limit::kNone) return change;
  speed_ = speed;
  speed_error_ = error;
  step_s_ = dt;
  return note_for_jerk(now);
}

// With what the ramp of a hold adds: a rate that changes by 2 in a second.
Breach ArmCheck::check_change(const std::array<JointAngles, 2>& next_speed,
                              const std::array<JointAngles, 2>& next_error, double next_s) const {
  const double mean_s = (step_s_ + next_s) / 2;
  for (const std::size_t clamp : {0, 1}) {
    const CellArm& arm = arm_at(clamp);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto k = static_cast<int>(i);
      const double before = speed_[clamp][k], after = next_speed[clamp][k];
      const double ramp = PathClock::kRampPerS * std::max(std::abs(before), std::abs(after));
      const double over = std::abs(after - before) / mean_s + ramp - arm.acceleration_rad_s2[i];
      const double rounding = speed_error_[clamp][k] + next_error[clamp][k];
      if (over > kRelative * arm.acceleration_rad_s2[i] + rounding / mean_s + PathClock::kRampPerS * rounding)
        return breach(Limit::kJointAcceleration, number(clamp), i + 1, over, kMillionths);
    }
  }
  return {};
}

Breach ArmCheck::note_for_jerk(const Met& now) {
  const auto add = [this](const Met& one) {
    if (far_count_ == far_.size()) {
      std::rotate(far_.begin(), far_.begin() + 1, far_.end());
      --far_count_;
    }
    far_[far_count_++] = one;
  };
  if (far_count_ == 0) {
    add(now);
    return {};
  }
  const double step = now.t - far_[far_count_ - 1].t;
  if (step < kJerkStep_s) return {};
  if (far_count_ == 1) {
    // At rest before the first.
    const Met first = far_[0];
    far_count_ = 0;
    for (const double out : {2.0, 1.0, 0.0}) {
      Met rest = first;
      rest.t -= out * step;
      add(rest);
    }
  }
  add(now);
  return check_jerk();
}

Breach ArmCheck::check_jerk() const {
  if (far_count_ < far_.size()) return {};
  std::array<double, 4> t{};
  for (std::size_t m = 0; m < t.size(); ++m) t[m] = far_[m].t;
  const double last_s = t[3] - t[2];
  for (const std::size_t clamp : {0, 1}) {
    const CellArm& arm = arm_at(clamp);
    const JointAngles late = (far_[3].q[clamp] - far_[2].q[clamp]).cwiseAbs() * (kMicrosecond_s / last_s);
    std::array<JointAngles, 4> q, error;
    for (std::size_t m = 0; m < t.size(); ++m) {
      q[m] = far_[m].q[clamp];
      error[m] = far_[m].rounding[clamp] + late;
    }
    const JointAngles jerk = third_derivative(t, q), slack = third_derivative_error(t, error);
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto k = static_cast<int>(i);
      const double over = std::abs(jerk[k]) - arm.jerk_rad_s3[i];
      if (over > kRelative * arm.jerk_rad_s3[i] + slack[k])
        return breach(Limit::kJointJerk, number(clamp), i + 1, over, kMillionths);
    }
    for (const bool turn : {false, true}) {
      const double most = turn ? cell_->limits().angular_jerk_rad_s3 : cell_->limits().jerk_mm_s3;
      if (!(most > 0)) continue;
      std::array<Vector3d, 4> f, error_of;
      for (std::size_t m = 0; m < t.size(); ++m) f[m] = turn ? far_[m].turned[clamp] : far_[m].place[clamp];
      const double rounding =
          (turn ? kRounding_rad : kRounding_mm) + (f[3] - f[2]).norm() * kMicrosecond_s / last_s;
      error_of.fill(Vector3d(rounding, 0, 0));
      const double over = third_derivative(t, f).norm() - most;
      if (over <= kRelative * most + third_derivative_error(t, error_of).norm()) continue;
      Breach found = breach(Limit::kJointJerk, 0, clamp + 1, over, turn ? kMillionths : kThousandths);
      if (turn) found.detail.other = ArmsOther::kOtherArm;
      return found;
    }
  }
  return {};
}

Breach ArmCheck::finish() {
  if (!checks() || !fits_ || !met_ || step_s_ <= 0) return {};
  const std::array<JointAngles, 2> rest{JointAngles::Zero(), JointAngles::Zero()};
  if (const Breach stop = check_change(rest, rest, step_s_); stop.limit != Limit::kNone) return stop;
  // At rest behind the last; a last step that was too short for jerk counts with the rest.
  const Met last = *met_;
  for (const double out : {0.0, 1.0, 2.0}) {
    Met rested = last;
    rested.t += out * std::max(step_s_, kJerkStep_s);
    if (const Breach found = note_for_jerk(rested); found.limit != Limit::kNone) return found;
  }
  return {};
}

std::optional<std::array<JointAngles, 2>> ArmCheck::joints() const {
  if (!checks() || !fits_ || !begun_) return std::nullopt;
  return std::array<JointAngles, 2>{posture_[0].q, posture_[1].q};
}

}  // namespace hotblade::robot
