// The inverse of an arm with a spherical wrist: shoulder, elbow and wrist one after the other, two roots
// each.
#include <algorithm>
#include <cmath>

#include "elastica/linear/solve.hpp"
#include "robot/arm/arm.hpp"

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// A radicand this far below zero, relative to the square it is the rest of, is rounding: a pose that is
// exactly stretched comes out on either side.
constexpr double kRadicandSlack = 1e-9;
// Axis 6 this near to axis 4 leaves joint 4 free: a direction below it is rounding of unit vectors.
constexpr double kStraightWrist = 1e-12;
// Newton steps on the axes of a rounded file, and what has to be left after them. Four leave 4e-12 mm on the
// worst file known (angles with five digits); what does not come there lies in a singularity.
constexpr int kNewtonSteps = 4;
constexpr double kNewtonLeft_rad = 1e-9, kNewtonLeft_mm = 1e-6;
// Weighs mm against rad in a Newton step: an arm reaches about so far.
constexpr double kArmLength_mm = 1000;

Vector3d turned(double c, double s, const Vector3d& axis, const Vector3d& v) {
  return c * v + s * axis.cross(v) + (1 - c) * axis.dot(v) * axis;
}

Vector3d turned_by(const Vector3d& axis, double angle, const Vector3d& v) {
  return turned(std::cos(angle), std::sin(angle), axis, v);
}

Vector3d square_to(const Vector3d& axis, const Vector3d& v) {
  return v - axis.dot(v) * axis;
}

// The angle in (-pi, pi].
double wrapped(double angle) {
  const double turns = std::remainder(angle, 2 * M_PI);
  return turns <= -M_PI ? turns + 2 * M_PI : turns;
}

// The two angles q with a cos q + b sin q = c.
struct Roots {
  bool there = false;
  std::array<double, 2> q{};
};

Roots roots_of(double a, double b, double c) {
  const double amplitude = std::hypot(a, b);
  double radicand = (amplitude - c) * (amplitude + c);
  if (!(radicand >= -kRadicandSlack * amplitude * amplitude)) return {};
  if (radicand < 0) radicand = 0;
  const double middle = std::atan2(b, a), half = std::atan2(std::sqrt(radicand), c);
  return {true, {wrapped(middle - half), wrapped(middle + half)}};
}

// Coefficients of q1: turned back, the wrist's centre is as far along axis 2 as it is at zero.
struct Equation {
  double a = 0, b = 0, c = 0;
  [[nodiscard]] Roots roots() const { return roots_of(a, b, c); }
};

Equation shoulder_equation(const Arm& arm, const Vector3d& wrist) {
  const Joint& j1 = arm.joints()[0];
  const Vector3d& u2 = arm.joints()[1].axis;
  const Vector3d v = wrist - j1.point_mm, square = square_to(j1.axis, v);
  return {u2.dot(square), -u2.dot(j1.axis.cross(v)),
          u2.dot(arm.wrist_at_zero() - j1.point_mm) - u2.dot(v - square)};
}

// The upper arm from axis 2 to axis 3, and the lower arm from axis 3 to the wrist, at zero and square to axis
// 2.
struct Limbs {
  Vector3d upper, lower;
};

Limbs limbs_of(const Arm& arm) {
  const Vector3d& u2 = arm.joints()[1].axis;
  const Vector3d &p2 = arm.joints()[1].point_mm, &p3 = arm.joints()[2].point_mm;
  return {square_to(u2, p3 - p2), square_to(u2, arm.wrist_at_zero() - p3)};
}

// Where the wrist's centre is from axis 2, square to it, with joint 1 turned back.
Vector3d from_axis_2(const Arm& arm, const Vector3d& wrist, double q1) {
  const Joint &j1 = arm.joints()[0], &j2 = arm.joints()[1];
  const Vector3d back = turned_by(j1.axis, -q1, wrist - j1.point_mm) + j1.point_mm;
  return square_to(j2.axis, back - j2.point_mm);
}

Equation elbow_equation(const Arm& arm, const Limbs& limbs, double distance2) {
  const Vector3d& u3 = arm.joints()[2].axis;
  return {limbs.upper.dot(limbs.lower), limbs.upper.dot(u3.cross(limbs.lower)),
          (distance2 - limbs.upper.squaredNorm() - limbs.lower.squaredNorm()) / 2};
}

double angle_about(const Vector3d& axis, const Vector3d& from, const Vector3d& to) {
  const Vector3d a = square_to(axis, from), b = square_to(axis, to);
  return std::atan2(axis.dot(a.cross(b)), a.dot(b));
}

// Any direction square to the axis.
Vector3d some_square(const Vector3d& axis) {
  int least = 0;
  axis.cwiseAbs().minCoeff(&least);
  return axis.cross(Vector3d::Unit(least)).normalized();
}

Matrix3d turn(const Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

// Joints 4, 5 and 6 by what orientation is left to them.
std::array<Eigen::Vector3d, 2> wrist_joints(const Arm& arm, const Matrix3d& left) {
  const Vector3d &u4 = arm.joints()[3].axis, &u5 = arm.joints()[4].axis, &u6 = arm.joints()[5].axis;
  const Vector3d g = left * u6, side = square_to(u4, g);
  const double middle = std::atan2(u4.dot(u5.cross(u6)), u4.dot(u6));
  const double half = std::atan2(side.norm(), u4.dot(g));
  std::array<Eigen::Vector3d, 2> both;
  for (std::size_t k = 0; k < 2; ++k) {
    const double q5 = wrapped(k == 0 ? middle - half : middle + half);
    const Vector3d bent = turned_by(u5, q5, u6);
    const double q4 = side.norm() < kStraightWrist ? 0 : angle_about(u4, bent, g);
    const Vector3d mark = some_square(u6);
    const Vector3d seen = turned_by(u5, -q5, turned_by(u4, -q4, left * mark));
    both[k] = {wrapped(q4), q5, wrapped(angle_about(u6, mark, seen))};
  }
  return both;
}

// Newton steps on the true axes. Returns whether they came to the flange.
bool refine(const Arm& arm, const Isometry3d& flange, JointAngles& q) {
  for (int step = 0;; ++step) {
    const auto motions = link_motions(arm, q);
    const Isometry3d off = flange * (motions.back() * arm.flange_at_zero()).inverse();
    const Matrix3d skew = (off.linear() - off.linear().transpose()) / 2;
    const Vector3d turn_left(skew(2, 1), skew(0, 2), skew(1, 0));
    // What is left at the flange, and not at the base, which is far off.
    const Vector3d at = flange.translation();
    const Vector3d way_left = at - off.inverse() * at;
    if (step == kNewtonSteps) return turn_left.norm() <= kNewtonLeft_rad && way_left.norm() <= kNewtonLeft_mm;
    Eigen::MatrixXd jacobian(6, 6);
    Eigen::VectorXd left(6);
    left << turn_left, way_left / kArmLength_mm;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const Vector3d axis = motions[i].linear() * arm.joints()[i].axis;
      const Vector3d point = motions[i] * arm.joints()[i].point_mm;
      jacobian.col(static_cast<int>(i)) << axis, axis.cross(at - point) / kArmLength_mm;
    }
    q += elastica::shortest_solution(jacobian, left);
  }
}

Vector3d wrist_centre(const Arm& arm, const Isometry3d& flange) {
  return flange * (arm.flange_at_zero().inverse() * arm.wrist_at_zero());
}

}  // namespace

Solutions inverse(const Arm& arm, const Isometry3d& flange) {
  Solutions solutions;
  const Matrix3d turn_of_flange = flange.linear() * arm.flange_at_zero().linear().transpose();
  const Vector3d wrist = wrist_centre(arm, flange);
  const auto& joints = arm.joints();
  const Limbs limbs = limbs_of(arm);
  const Roots shoulders = shoulder_equation(arm, wrist).roots();
  if (!shoulders.there) return solutions;
  for (std::size_t shoulder = 0; shoulder < 2; ++shoulder) {
    const double q1 = shoulders.q[shoulder];
    const Vector3d y = from_axis_2(arm, wrist, q1);
    const Roots elbows = elbow_equation(arm, limbs, y.squaredNorm()).roots();
    if (!elbows.there) continue;
    for (std::size_t elbow = 0; elbow < 2; ++elbow) {
      const double q3 = elbows.q[elbow];
      const double q2 =
          angle_about(joints[1].axis, limbs.upper + turned_by(joints[2].axis, q3, limbs.lower), y);
      const Matrix3d carried = turn(joints[0].axis, q1) * turn(joints[1].axis, q2) * turn(joints[2].axis, q3);
      const auto wrists = wrist_joints(arm, carried.transpose() * turn_of_flange);
      for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t branch = 4 * shoulder + 2 * elbow + k;
        solutions.q[branch] << q1, q2, q3, wrists[k];
        solutions.there[branch] = arm.exact() || refine(arm, flange, solutions.q[branch]);
      }
    }
  }
  return solutions;
}

Reach reach(const Arm& arm, const Isometry3d& flange) {
  const Vector3d wrist = wrist_centre(arm, flange);
  const Equation shoulder = shoulder_equation(arm, wrist);
  const Limbs limbs = limbs_of(arm);
  Reach reach;
  reach.least_mm = std::abs(limbs.upper.norm() - limbs.lower.norm());
  reach.most_mm = limbs.upper.norm() + limbs.lower.norm();
  reach.from_axis_1_mm = std::hypot(shoulder.a, shoulder.b);
  reach.least_from_axis_1_mm = std::abs(shoulder.c);
  const Roots roots = shoulder.roots();
  const double middle = std::atan2(shoulder.b, shoulder.a);
  const auto off = [&](double distance) {
    return std::max({distance - reach.most_mm, reach.least_mm - distance, 0.0});
  };
  for (std::size_t k = 0; k < 2; ++k) {
    const double distance = from_axis_2(arm, wrist, roots.there ? roots.q[k] : middle).norm();
    if (k == 0 || off(distance) < off(reach.from_axis_2_mm)) reach.from_axis_2_mm = distance;
  }
  return reach;
}

}  // namespace hotblade::robot
