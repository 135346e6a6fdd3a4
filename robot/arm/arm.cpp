#include "robot/arm/arm.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Relation = AxisError::Relation;

// Axes nearer than this are one line: the elbow or the shoulder would not turn anything.
constexpr double kLeastLink_mm = 1;

Vector3d turned(const Vector3d& axis, double angle, const Vector3d& v) {
  const double c = std::cos(angle), s = std::sin(angle);
  return c * v + s * axis.cross(v) + (1 - c) * axis.dot(v) * axis;
}

Vector3d square_part(const Vector3d& axis, const Vector3d& v) {
  return v - axis.dot(v) * axis;
}

// atan2 keeps small angles, which an arc cosine loses.
double angle_between(const Vector3d& u, const Vector3d& v) {
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

// The middle of the shortest way between two lines that are not parallel, and its length.
std::pair<Vector3d, double> meeting_point(const Joint& a, const Joint& b) {
  const Vector3d between = b.point_mm - a.point_mm;
  const double c = a.axis.dot(b.axis), square = 1 - c * c;
  if (square <= 0) return {a.point_mm, square_part(a.axis, between).norm()};
  const double along_a = (between.dot(a.axis) - c * between.dot(b.axis)) / square;
  const double along_b = (c * between.dot(a.axis) - between.dot(b.axis)) / square;
  const Vector3d on_a = a.point_mm + along_a * a.axis, on_b = b.point_mm + along_b * b.axis;
  return {(on_a + on_b) / 2, (on_b - on_a).norm()};
}

AxisError angle_error(const std::array<Joint, kJoints>& joints, std::size_t first, Relation relation) {
  const double angle = angle_between(joints[first].axis, joints[first + 1].axis);
  const double off =
      relation == Relation::kSquare ? std::abs(angle - M_PI / 2) : std::min(angle, M_PI - angle);
  return {first, first + 1, relation, off, 0};
}

bool within(const std::vector<AxisError>& errors, double angle_rad, double distance_mm) {
  for (const AxisError& e : errors) {
    if (!(e.angle_rad <= angle_rad && e.distance_mm <= distance_mm)) return false;
  }
  return true;
}

}  // namespace

std::vector<AxisError> axis_errors(const std::array<Joint, kJoints>& joints) {
  std::vector<AxisError> errors{
      angle_error(joints, 1, Relation::kParallel), angle_error(joints, 0, Relation::kSquare),
      angle_error(joints, 2, Relation::kSquare), angle_error(joints, 3, Relation::kSquare),
      angle_error(joints, 4, Relation::kSquare)};
  const auto [wrist, gap] = meeting_point(joints[3], joints[4]);
  errors.push_back({3, 4, Relation::kMeeting, 0, gap});
  errors.push_back(
      {4, 5, Relation::kMeeting, 0, square_part(joints[5].axis, wrist - joints[5].point_mm).norm()});
  return errors;
}

Arm::Arm(std::string name, const std::array<Joint, kJoints>& joints, const Isometry3d& flange_at_zero)
    : name_(std::move(name)), joints_(joints), flange_(flange_at_zero) {
  const std::vector<AxisError> errors = axis_errors(joints);
  if (!within(errors, kRoundedAxis_rad, kRoundedAxis_mm))
    throw std::logic_error("Arm: the axes are not those of an arm with a spherical wrist");
  exact_ = within(errors, kExactAxis_rad, kExactAxis_mm);
  wrist_ = meeting_point(joints[3], joints[4]).first;
  const Vector3d& u = joints[2].axis;
  if (square_part(u, joints[2].point_mm - joints[1].point_mm).norm() < kLeastLink_mm ||
      square_part(u, wrist_ - joints[2].point_mm).norm() < kLeastLink_mm)
    throw std::logic_error("Arm: axes 2 and 3, or axis 3 and the wrist, are in one line");
}

Arm Arm::with_limits(const JointAngles& min_rad, const JointAngles& max_rad) const {
  Arm arm = *this;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto k = static_cast<int>(i);
    if (!(min_rad[k] < max_rad[k]))
      throw std::logic_error("Arm: a joint's least angle is not below its largest");
    arm.joints_[i].min_rad = min_rad[k];
    arm.joints_[i].max_rad = max_rad[k];
  }
  return arm;
}

ArmLengths Arm::lengths() const {
  const Vector3d &u1 = joints_[0].axis, &u2 = joints_[1].axis, &u4 = joints_[3].axis;
  const Vector3d forward_1 = u1.cross(u2);  // square to axes 1 and 2
  const Vector3d from_3 = wrist_ - joints_[2].point_mm;
  return {std::abs(forward_1.dot(joints_[1].point_mm - joints_[0].point_mm)),
          std::abs(u2.cross(u4).dot(from_3)),
          std::abs(u2.dot(wrist_ - joints_[0].point_mm)),
          std::abs(u1.dot(joints_[1].point_mm)),
          square_part(u2, joints_[2].point_mm - joints_[1].point_mm).norm(),
          std::abs(u4.dot(from_3)),
          (flange_.translation() - wrist_).norm()};
}

Isometry3d turn_about(const Vector3d& axis, const Vector3d& point_mm, double angle_rad) {
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
  motion.translation() = point_mm - motion.linear() * point_mm;
  return motion;
}

std::array<Isometry3d, kJoints + 1> link_motions(const Arm& arm, const JointAngles& q) {
  std::array<Isometry3d, kJoints + 1> motions;
  motions[0].setIdentity();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Joint& joint = arm.joints()[i];
    motions[i + 1] = motions[i] * turn_about(joint.axis, joint.point_mm, q[static_cast<int>(i)]);
  }
  return motions;
}

Isometry3d forward(const Arm& arm, const JointAngles& q) {
  return link_motions(arm, q).back() * arm.flange_at_zero();
}

std::array<int, 3> branch_signs(std::size_t branch) {
  const auto sign = [branch](unsigned bit) { return (branch >> bit & 1U) != 0 ? 1 : -1; };
  return {sign(2), sign(1), sign(0)};
}

SingularityDistances singularity_distances(const Arm& arm, const JointAngles& q) {
  const auto& joints = arm.joints();
  const auto folded = [](double angle) { return std::min(angle, M_PI - angle); };
  const Vector3d &u1 = joints[0].axis, &u2 = joints[1].axis, &u3 = joints[2].axis;
  const Vector3d upper = square_part(u3, joints[2].point_mm - joints[1].point_mm);
  const Vector3d lower = turned(u3, q[2], square_part(u3, arm.wrist_at_zero() - joints[2].point_mm));
  const Vector3d wrist = joints[1].point_mm + turned(u2, q[1], upper + lower);
  SingularityDistances distances;
  distances.wrist_rad = folded(angle_between(joints[3].axis, turned(joints[4].axis, q[4], joints[5].axis)));
  distances.elbow_rad = folded(angle_between(upper, lower));
  distances.shoulder_mm = std::abs(u1.cross(u2).dot(wrist - joints[0].point_mm));
  return distances;
}

}  // namespace hotblade::robot
