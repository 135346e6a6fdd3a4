// Forward and inverse of arms: by round trips, at singularities, and against KDL and Newton's method.
#include <gtest/gtest.h>

#include <cmath>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>

#include "elastica/linear/solve.hpp"
#include "robot/arm/arm.hpp"
#include "tests/robot/arm/arms.hpp"

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kPosition_mm = 1e-9, kTurn_rad = 1e-12;

struct Off {
  double mm = 0, rad = 0;
};

// How far a flange is from another. An angle from the skew part keeps its digits where it is small.
Off between(const Isometry3d& a, const Isometry3d& b) {
  const Eigen::Matrix3d turn = a.linear().transpose() * b.linear();
  const Vector3d sine(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  return {(a.translation() - b.translation()).norm(), std::atan2(sine.norm() / 2, (turn.trace() - 1) / 2)};
}

// The worst of all solutions of a flange, and how far the nearest of them is from joints that led there.
struct RoundTrip {
  Off worst;
  int solutions = 0;
  double own_rad = 1e9;
};

double apart(const JointAngles& a, const JointAngles& b) {
  double most = 0;
  for (int i = 0; i < a.size(); ++i) most = std::max(most, std::abs(std::remainder(a[i] - b[i], 2 * M_PI)));
  return most;
}

RoundTrip round_trip(const Arm& arm, const JointAngles& q) {
  RoundTrip trip;
  const Isometry3d flange = forward(arm, q);
  const Solutions solutions = inverse(arm, flange);
  for (std::size_t i = 0; i < kBranches; ++i) {
    if (!solutions.there[i]) continue;
    ++trip.solutions;
    const Off off = between(forward(arm, solutions.q[i]), flange);
    trip.worst.mm = std::max(trip.worst.mm, off.mm);
    trip.worst.rad = std::max(trip.worst.rad, off.rad);
    trip.own_rad = std::min(trip.own_rad, apart(solutions.q[i], q));
  }
  return trip;
}

TEST(Inverse, ComesBackOnAMillionPoses) {
  for (const char* name : kShippedArms) {
    const Arm arm = read_urdf(shipped_arm(name)).arm;
    std::mt19937_64 random(20);
    Off worst;
    double own = 0;
    for (int i = 0; i < 1'000'000; ++i) {
      const RoundTrip trip = round_trip(arm, random_joints(arm, random));
      worst.mm = std::max(worst.mm, trip.worst.mm);
      worst.rad = std::max(worst.rad, trip.worst.rad);
      own = std::max(own, trip.own_rad);
    }
    EXPECT_LE(worst.mm, kPosition_mm) << name;
    EXPECT_LE(worst.rad, kTurn_rad) << name;
    // Near a singularity a joint is known to the root of the rounding only.
    EXPECT_LE(own, 1e-5) << name << ": the joints that led there are among the solutions";
    RecordProperty(std::string(name) + "_mm", std::to_string(worst.mm));
    std::printf("%s: %.3g mm, %.3g rad, own joints within %.3g rad\n", name, worst.mm, worst.rad, own);
  }
}

// The angle of joint 3 at which the elbow is stretched.
double stretched(const Arm& arm) {
  const Vector3d &u = arm.joints()[2].axis, &p3 = arm.joints()[2].point_mm;
  const Vector3d upper = p3 - arm.joints()[1].point_mm, lower = arm.wrist_at_zero() - p3;
  const Vector3d a = upper - u.dot(upper) * u, b = lower - u.dot(lower) * u;
  return std::atan2(u.dot(b.cross(a)), b.dot(a));
}

TEST(Inverse, KeepsItsDigitsAtSingularities) {
  for (const char* name : kShippedArms) {
    const Arm arm = read_urdf(shipped_arm(name)).arm;
    std::mt19937_64 random(21);
    Off worst;
    for (double off = 1; off >= 1e-9; off /= 10) {
      // The last round is singular to rounding.
      const double angle = off > 5e-9 ? off : 0;
      for (int i = 0; i < 2000; ++i) {
        for (const int which : {0, 1, 2}) {
          JointAngles q = random_joints(arm, random);
          if (which != 1) q[4] = angle;
          if (which != 0) q[2] = stretched(arm) + angle;
          const RoundTrip trip = round_trip(arm, q);
          ASSERT_GE(trip.solutions, 2) << name << " lost solutions at " << angle;
          worst.mm = std::max(worst.mm, trip.worst.mm);
          worst.rad = std::max(worst.rad, trip.worst.rad);
        }
      }
    }
    EXPECT_LE(worst.mm, kPosition_mm) << name;
    EXPECT_LE(worst.rad, kTurn_rad) << name;
    std::printf("%s: %.3g mm, %.3g rad\n", name, worst.mm, worst.rad);
  }
}

TEST(Inverse, KeepsItsDigitsOverAxisOne) {
  for (const char* name : kShippedArms) {
    const Arm arm = read_urdf(shipped_arm(name)).arm;
    std::mt19937_64 random(22);
    for (double off = 100; off >= 1e-8; off /= 10) {
      for (int i = 0; i < 500; ++i) {
        JointAngles q = random_joints(arm, random);
        Isometry3d flange = forward(arm, q);
        // The wrist's centre is moved next to axis 1, where it is within reach if it was high enough.
        const Vector3d wrist = flange * (arm.flange_at_zero().inverse() * arm.wrist_at_zero());
        flange.translation() -= Vector3d(wrist.x() - off, wrist.y(), wrist.z() - 1900);
        const Solutions solutions = inverse(arm, flange);
        for (std::size_t k = 0; k < kBranches; ++k) {
          ASSERT_TRUE(solutions.there[k]) << name << ": " << off << " mm from axis 1";
          const Off found = between(forward(arm, solutions.q[k]), flange);
          EXPECT_LE(found.mm, kPosition_mm) << name;
          EXPECT_LE(found.rad, kTurn_rad) << name;
        }
      }
    }
  }
}

// One of Newton's steps with a Jacobian by differences.
JointAngles newton(const Arm& arm, const Isometry3d& flange, JointAngles q) {
  const auto left = [&](const JointAngles& at) {
    const Isometry3d now = forward(arm, at);
    Eigen::VectorXd rest(12);
    rest << (flange.translation() - now.translation()) / 1000, (flange.linear() - now.linear()).reshaped();
    return rest;
  };
  for (int step = 0; step < 60; ++step) {
    const Eigen::VectorXd rest = left(q);
    if (rest.norm() < 1e-12) break;
    Eigen::MatrixXd jacobian(12, 6);
    for (int i = 0; i < 6; ++i) {
      JointAngles more = q, less = q;
      more[i] += 1e-6;
      less[i] -= 1e-6;
      jacobian.col(i) = (left(less) - left(more)) / 2e-6;
    }
    JointAngles move = elastica::shortest_solution(jacobian, rest);
    if (move.norm() > 0.5) move *= 0.5 / move.norm();
    q += move;
  }
  return q;
}

TEST(Inverse, FindsWhatNewtonFinds) {
  int found = 0;
  for (const char* name : kShippedArms) {
    const Arm arm = read_urdf(shipped_arm(name)).arm;
    std::mt19937_64 random(23);
    for (int i = 0; i < 40; ++i) {
      const Isometry3d flange = forward(arm, random_joints(arm, random));
      const Solutions solutions = inverse(arm, flange);
      for (int start = 0; start < 60; ++start) {
        const JointAngles q = newton(arm, flange, random_joints(arm, random));
        if (between(forward(arm, q), flange).mm > 1e-6) continue;  // it went nowhere
        ++found;
        double nearest = 1e9;
        for (std::size_t k = 0; k < kBranches; ++k) {
          if (solutions.there[k]) nearest = std::min(nearest, apart(solutions.q[k], q));
        }
        EXPECT_LE(nearest, 1e-4) << name << ": a solution is missing";
      }
    }
  }
  EXPECT_GT(found, 2000);
}

TEST(Inverse, TurnsOneMoreStepOnRoundedAxes) {
  std::array<Joint, kJoints> joints = read_urdf(shipped_arm("abb_irb4600_40_255")).arm.joints();
  const Isometry3d flange = read_urdf(shipped_arm("abb_irb4600_40_255")).arm.flange_at_zero();
  // As a file leaves them that writes 1.5708 for a right angle and lengths in hundredths of a millimetre.
  joints[3].axis = (joints[3].axis + Vector3d(0, 4e-6, -3e-6)).normalized();
  joints[4].axis = (joints[4].axis + Vector3d(2e-6, 0, 4e-6)).normalized();
  joints[5].point_mm += Vector3d(0, 0.005, -0.003);
  joints[2].axis = (joints[2].axis + Vector3d(4e-6, 0, 1e-6)).normalized();
  const Arm arm("rounded", joints, flange);
  EXPECT_FALSE(arm.exact());
  std::mt19937_64 random(24);
  int all = 0, lost = 0;
  for (int i = 0; i < 20000; ++i) {
    const RoundTrip trip = round_trip(arm, random_joints(arm, random));
    EXPECT_LE(trip.worst.mm, 1e-6);
    EXPECT_LE(trip.worst.rad, 1e-9);
    ++all;
    lost += trip.own_rad > 1e-4 ? 1 : 0;
  }
  EXPECT_LE(lost, all / 1000) << "only where a pose is next to singular";
}

TEST(Inverse, SaysHowFarAPlaceIsOutOfReach) {
  const Arm arm = read_urdf(shipped_arm("kuka_kr50_r2500")).arm;
  Isometry3d flange = forward(arm, (JointAngles() << 0, -0.5, 1, 0, 0.5, 0).finished());
  EXPECT_LE(reach(arm, flange).from_axis_2_mm, reach(arm, flange).most_mm);
  flange.translation() += Vector3d(2000, 0, 0);
  const Solutions none = inverse(arm, flange);
  for (std::size_t k = 0; k < kBranches; ++k) EXPECT_FALSE(none.there[k]);
  const Reach far = reach(arm, flange);
  EXPECT_GT(far.from_axis_2_mm, far.most_mm);
  EXPECT_NEAR(far.most_mm, 1290 + std::hypot(1035, 50), 1e-9);
  EXPECT_NEAR(far.least_mm, 1290 - std::hypot(1035, 50), 1e-9);
}

TEST(SingularityDistances, VanishWithTheDeterminant) {
  for (const char* name : kShippedArms) {
    const Arm arm = read_urdf(shipped_arm(name)).arm;
    std::mt19937_64 random(25);
    double factor = 0;
    for (int i = 0; i < 200; ++i) {
      const JointAngles q = random_joints(arm, random);
      const auto motions = link_motions(arm, q);
      const Vector3d at = forward(arm, q).translation();
      Eigen::Matrix<double, 6, 6> jacobian;
      for (std::size_t k = 0; k < kJoints; ++k) {
        const Vector3d axis = motions[k].linear() * arm.joints()[k].axis;
        jacobian.col(static_cast<int>(k)) << axis, axis.cross(at - motions[k] * arm.joints()[k].point_mm);
      }
      const SingularityDistances d = singularity_distances(arm, q);
      const double product = std::sin(d.wrist_rad) * std::sin(d.elbow_rad) * d.shoulder_mm;
      const double ratio = std::abs(jacobian.determinant()) / product;
      if (factor == 0) factor = ratio;
      EXPECT_NEAR(ratio / factor, 1, 1e-6) << name;
    }
  }
}

// The same axes as a chain of KDL, in metres.
KDL::Chain kdl_chain(const Arm& arm) {
  const auto vector = [](const Vector3d& v) { return KDL::Vector(v.x(), v.y(), v.z()); };
  KDL::Chain chain;
  for (const Joint& joint : arm.joints()) {
    // A segment of no length that turns about a line of the base: its frame is the base's own again.
    chain.addSegment(
        KDL::Segment(KDL::Joint("j", vector(joint.point_mm / 1000), vector(joint.axis), KDL::Joint::RotAxis),
                     KDL::Frame::Identity()));
  }
  const Eigen::Matrix3d r = arm.flange_at_zero().linear();
  const KDL::Rotation turn(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2));
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None),
                                KDL::Frame(turn, vector(arm.flange_at_zero().translation() / 1000))));
  return chain;
}

TEST(Forward, AgreesWithKdl) {
  for (const auto& file : arm_files()) {
    const Arm arm = read_urdf(file).arm;
    KDL::Chain chain = kdl_chain(arm);
    KDL::ChainFkSolverPos_recursive solver(chain);
    std::mt19937_64 random(26);
    for (int i = 0; i < 1000; ++i) {
      const JointAngles q = random_joints(arm, random);
      KDL::JntArray joints(6);
      for (unsigned k = 0; k < 6; ++k) joints(k) = q[static_cast<int>(k)];
      KDL::Frame frame;
      ASSERT_GE(solver.JntToCart(joints, frame), 0);
      const Isometry3d flange = forward(arm, q);
      for (int row = 0; row < 3; ++row) {
        EXPECT_NEAR(frame.p(row), flange.translation()[row] / 1000, 1e-9) << file;
        for (int column = 0; column < 3; ++column)
          EXPECT_NEAR(frame.M(row, column), flange.linear()(row, column), 1e-12) << file;
      }
    }
  }
}

}  // namespace
}  // namespace hotblade::robot
