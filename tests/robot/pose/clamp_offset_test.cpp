#include "robot/pose/clamp_offset.hpp"

#include <gtest/gtest.h>

namespace hotblade::robot {
namespace {

const Pose kPose{{120, -40, 900},
                 Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()))};
const ClampOffset kOffset{{0.8, -0.3, 0.5}, {0.004, -0.002, 0.006}};

TEST(ClampOffset, WhatIsToldIsHeldWhereItShouldBe) {
  const Pose back = held(told(kPose, kOffset), kOffset);
  EXPECT_LT((back.p - kPose.p).norm(), 1e-12);
  EXPECT_LT(back.q.angularDistance(kPose.q), 1e-12);
}

TEST(ClampOffset, StandsInTheClampsOwnAxes) {
  const Pose is = held(kPose, kOffset);
  const Eigen::Vector3d shift = kPose.q.conjugate() * (is.p - kPose.p);
  EXPECT_LT((shift - Eigen::Vector3d(0.8, -0.3, 0.5)).norm(), 1e-12);
  const Eigen::AngleAxisd turn(kPose.q.conjugate() * is.q);
  EXPECT_LT((turn.angle() * turn.axis() - Eigen::Vector3d(0.004, -0.002, 0.006)).norm(), 1e-12);
}

TEST(ClampOffset, NoneChangesNoBit) {
  const Pose is = held(kPose, {}), should = told(kPose, {});
  EXPECT_EQ(is.p, kPose.p);
  EXPECT_EQ(is.q.coeffs(), kPose.q.coeffs());
  EXPECT_EQ(should.p, kPose.p);
  EXPECT_EQ(should.q.coeffs(), kPose.q.coeffs());
}

}  // namespace
}  // namespace hotblade::robot
