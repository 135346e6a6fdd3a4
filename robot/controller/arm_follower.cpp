#include "robot/controller/arm_follower.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// What a jaw is off by when Newton's method has come to it: rounding of a cell's coordinates.
constexpr double kThere_mm = 1e-8, kThere_rad = 1e-11;
// From 10 ms before two or three steps suffice; damped ones bring an arm that does not reach as near as it
// gets.
constexpr int kNewtonSteps = 8, kDampedSteps = 40;
// No joint turns farther in one step: beyond, the linear equations say nothing any more.
constexpr double kLargestStep_rad = 0.2;
// Weighs mm against rad, and what a damped step leaves of the directions that an arm has lost.
constexpr double kArmLength_mm = 1000, kDamping = 1e-3;

Isometry3d turned(const Isometry3d& motion, const Joint& joint, double angle) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, joint.axis));
  Isometry3d after = motion;
  after.linear() = motion.linear() * turn.toRotationMatrix();
  after.translation() = motion * (joint.point_mm - turn * joint.point_mm);
  return after;
}

Vector3d square_to(const Vector3d& axis, const Vector3d& v) {
  return v - axis.dot(v) * axis;
}

// How the jaw turns and moves, mm as shares of an arm's length, by each joint.
Matrix6d jacobian_of(const ArmPosture& posture) {
  Matrix6d jacobian;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Vector3d arm = posture.jaw.translation() - posture.point_mm[i];
    jacobian.col(static_cast<int>(i)) << posture.axis[i], posture.axis[i].cross(arm) / kArmLength_mm;
  }
  return jacobian;
}

JointAngles within_step(JointAngles step) {
  const double largest = step.cwiseAbs().maxCoeff();
  if (!(largest < std::numeric_limits<double>::infinity())) return JointAngles::Zero();
  return largest > kLargestStep_rad ? JointAngles(step * (kLargestStep_rad / largest)) : step;
}

}  // namespace

Isometry3d isometry(const Pose& pose) {
  Isometry3d place = Isometry3d::Identity();
  place.linear() = pose.q.toRotationMatrix();
  place.translation() = pose.p;
  return place;
}

ArmPosture posture_of(const CellArm& arm, const JointAngles& q) {
  ArmPosture posture;
  posture.q = q;
  const Arm& model = arm.model.arm;
  Isometry3d motion = isometry(arm.base);
  posture.links[0] = motion;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Joint& joint = model.joints()[i];
    posture.axis[i] = motion.linear() * joint.axis;
    posture.point_mm[i] = motion * joint.point_mm;
    motion = turned(motion, joint, q[static_cast<int>(i)]);
    posture.links[i + 1] = motion;
  }
  posture.wrist_mm = posture.links[3] * model.wrist_at_zero();
  posture.jaw = motion * model.flange_at_zero() * jaw_in_flange(arm.tool);
  return posture;
}

ArmBends bends_of(const ArmPosture& posture) {
  const auto folded = [](const Vector3d& about, const Vector3d& a, const Vector3d& b) {
    const double angle = std::atan2(about.dot(a.cross(b)), a.dot(b));
    return std::copysign(std::min(std::abs(angle), M_PI - std::abs(angle)), angle);
  };
  const auto& axis = posture.axis;
  const auto& point = posture.point_mm;
  const Vector3d upper = square_to(axis[2], point[2] - point[1]),
                 lower = square_to(axis[2], posture.wrist_mm - point[2]);
  return {folded(axis[4], axis[3], axis[5]), folded(axis[2], upper, lower),
          axis[0].cross(axis[1]).dot(posture.wrist_mm - point[0])};
}

JawOff off(const ArmPosture& posture, const Isometry3d& jaw) {
  const Matrix3d left = jaw.linear() * posture.jaw.linear().transpose();
  const Eigen::Quaterniond turn(left);
  const double sine = turn.vec().norm(), angle = 2 * std::atan2(sine, std::abs(turn.w()));
  const double sign = turn.w() < 0 ? -1 : 1;
  return {jaw.translation() - posture.jaw.translation(),
          sine > 0 ? Vector3d(turn.vec() * (sign * angle / sine)) : Vector3d(0, 0, 0)};
}

FollowedJoints follow(const CellArm& arm, const JointAngles& from, const Isometry3d& jaw) {
  FollowedJoints followed{from, false, std::numeric_limits<double>::infinity()};
  for (int step = 0; step <= kNewtonSteps + kDampedSteps; ++step) {
    const ArmPosture posture = posture_of(arm, followed.q);
    const JawOff left = off(posture, jaw);
    followed.there = left.way_mm.norm() <= kThere_mm && left.turn_rad.norm() <= kThere_rad;
    if (followed.there) return followed;
    followed.short_mm =
        std::min(followed.short_mm, left.way_mm.norm() + kArmLength_mm * left.turn_rad.norm());
    const Matrix6d jacobian = jacobian_of(posture);
    JointAngles wanted;
    wanted << left.turn_rad, left.way_mm / kArmLength_mm;
    if (step < kNewtonSteps) {
      followed.q += within_step(jacobian.partialPivLu().solve(wanted));
    } else {
      const Matrix6d damped = jacobian * jacobian.transpose() + kDamping * kDamping * Matrix6d::Identity();
      followed.q += within_step(jacobian.transpose() * damped.partialPivLu().solve(wanted));
    }
  }
  return followed;
}

JointAngles turned_by_rounding(const ArmPosture& posture, double way_mm, double turn_rad) {
  const Matrix6d inverse = jacobian_of(posture).partialPivLu().inverse();
  JointAngles most;
  for (int i = 0; i < most.size(); ++i)
    most[i] =
        inverse.row(i).head<3>().norm() * turn_rad + inverse.row(i).tail<3>().norm() * way_mm / kArmLength_mm;
  return most;
}

}  // namespace hotblade::robot
