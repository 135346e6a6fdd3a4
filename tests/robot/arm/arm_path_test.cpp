// Arms along paths of their flange.
#include "robot/arm/arm_path.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/robot/arm/arms.hpp"

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// A path of a flange in front of the arm: a bow that turns on its way.
std::vector<Isometry3d> bow(std::size_t poses, bool mirrored = false) {
  std::vector<Isometry3d> path;
  for (std::size_t i = 0; i < poses; ++i) {
    const double s = static_cast<double>(i) / static_cast<double>(poses - 1);
    Isometry3d flange = Isometry3d::Identity();
    flange.translation() = Vector3d(1500 + 150 * std::sin(5 * s), 900 * (s - 0.5), 700 + 200 * s);
    const Eigen::Matrix3d out = (Eigen::Matrix3d() << 0, 0, 1, 0, 1, 0, -1, 0, 0).finished();
    flange.linear() =
        Eigen::AngleAxisd(1.4 * s - 0.5, Vector3d(0.3, 0.5, 0.8).normalized()).toRotationMatrix() * out;
    if (mirrored) {
      // In the plane y = 0; the flange's own y is turned round as well, so that its axes stay right-handed.
      const Vector3d across(1, -1, 1);
      flange.translation() = across.cwiseProduct(flange.translation());
      flange.linear() = across.asDiagonal() * flange.linear() * across.asDiagonal();
    }
    path.push_back(flange);
  }
  return path;
}

double largest_step(const BranchPath& path) {
  double largest = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    largest = std::max(largest, (path[i] - path[i - 1]).cwiseAbs().maxCoeff());
  return largest;
}

TEST(ArmPath, HasNoJumps) {
  for (const char* name : kShippedArms) {
    const Arm arm = read_urdf(shipped_arm(name)).arm;
    const auto coarse = follow_branches(arm, bow(400)), fine = follow_branches(arm, bow(799));
    int whole = 0;
    for (std::size_t branch = 0; branch < kBranches; ++branch) {
      if (coarse[branch].size() != 400) continue;
      ASSERT_EQ(fine[branch].size(), 799U) << name;
      ++whole;
      // Half the step, half the way: to a tenth, as the path bends.
      EXPECT_NEAR(largest_step(fine[branch]) / largest_step(coarse[branch]), 0.5, 0.05) << name << branch;
      for (std::size_t i = 0; i < 400; ++i)
        EXPECT_LE((fine[branch][2 * i] - coarse[branch][i]).cwiseAbs().maxCoeff(), 1e-9)
            << "labels are constant";
    }
    EXPECT_GE(whole, 2) << name;
  }
}

TEST(ArmPath, MirrorsWithTheCell) {
  for (const char* name : kShippedArms) {
    const Arm arm = read_urdf(shipped_arm(name)).arm;
    const auto path = follow_branches(arm, bow(200)), mirror = follow_branches(arm, bow(200, true));
    // In the mirror joints 1, 4 and 6 turn the other way.
    JointAngles way;
    way << -1, 1, 1, -1, 1, -1;
    int found = 0;
    for (const BranchPath& one : path) {
      if (one.size() != 200) continue;
      for (const BranchPath& other : mirror) {
        if (other.size() != 200) continue;
        double apart = 0;
        for (std::size_t i = 0; i < 200; ++i) {
          const JointAngles off = way.cwiseProduct(one[i]) - other[i];
          for (int k = 0; k < off.size(); ++k)
            apart = std::max(apart, std::abs(std::remainder(off[k], 2 * M_PI)));
        }
        found += apart < 1e-9 ? 1 : 0;
      }
    }
    EXPECT_GE(found, 2) << name;
  }
}

TEST(ArmPath, EndsWhereTheArmDoes) {
  const Arm arm = read_urdf(shipped_arm("abb_irb4600_40_255")).arm;
  std::vector<Isometry3d> path = bow(50);
  path[30].translation() *= 3;
  for (const BranchPath& branch : follow_branches(arm, path)) EXPECT_LE(branch.size(), 30U);
}

TEST(ArmPath, KeepsJointFourThroughAStraightWrist) {
  const Arm arm = read_urdf(shipped_arm("abb_irb4600_40_255")).arm;
  std::vector<Isometry3d> flanges;
  const JointAngles start = (JointAngles() << 0.1, 0.2, 0.3, 0.7, 0.02, -0.4).finished();
  for (int i = 0; i <= 2; ++i) {
    JointAngles q = start;
    q[4] = 0.02 - 0.01 * i;
    flanges.push_back(forward(arm, q));
  }
  double nearest = 10;
  for (const BranchPath& branch : follow_branches(arm, flanges)) {
    if (branch.size() == 3 && (branch[0] - start).norm() < 1e-9)
      nearest = std::min(nearest, std::abs(branch[2][3] - 0.7) + std::abs(branch[2][5] + 0.4));
  }
  EXPECT_LE(nearest, 1e-6);
}

TEST(FitTurns, LeavesTheMost) {
  const Arm arm = read_urdf(shipped_arm("abb_irb4600_40_255")).arm;  // joints 4 and 6: 400 degrees either way
  const auto turns_of = [&](double low, double high, int joint) {
    JointAngles a = JointAngles::Zero(), b = a;
    a[joint] = low;
    b[joint] = high;
    return fit_turns(arm, std::vector<JointAngles>{a, b})[static_cast<std::size_t>(joint)];
  };
  EXPECT_EQ(turns_of(-0.5, 0.5, 3), 0);
  EXPECT_EQ(turns_of(3.0, 7.0, 3), -1);
  EXPECT_EQ(turns_of(-9.0, -3.0, 5), 1);
  EXPECT_EQ(turns_of(M_PI, M_PI, 5), 0) << "a tie goes towards none";
  EXPECT_EQ(turns_of(12.0, 13.0, 0), -2) << "outside the limits too";
}

TEST(PathMargins, AreTheLeast) {
  const Arm arm = read_urdf(shipped_arm("abb_irb4600_40_255")).arm;
  std::vector<JointAngles> path(3, (JointAngles() << 0, 0, 0, 0, 1, 0).finished());
  path[1][4] = 2.0;
  path[2][4] = -0.3;
  const PathMargins margins = path_margins(arm, path);
  EXPECT_NEAR(margins.joint_rad.value, 2.0943951023931953 - 2.0, 1e-12);
  EXPECT_EQ(margins.joint_rad.pose, 1U);
  EXPECT_EQ(margins.joint_rad.joint, 4U);
  EXPECT_NEAR(margins.wrist_rad.value, 0.3, 1e-12);
  EXPECT_EQ(margins.wrist_rad.pose, 2U);
  EXPECT_NEAR(margins.shoulder_mm.value, 1445, 1e-9);
  EXPECT_NEAR(margins.elbow_rad.value, std::atan2(1270, 175), 1e-12);
}

}  // namespace
}  // namespace hotblade::robot
