#include "pipeline/verify/blade_speeds.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

// A straight blade of 300 mm along x from `from`, half of it in foam.
BladePose straight(const Frame& frame, double t, double from = 0) {
  BladePose pose;
  pose.t = t;
  pose.frame = frame;
  pose.blade = {from, 0, 0, 0, 0, 0, 300};
  pose.foam = std::array<double, 2>{50, 200};
  return pose;
}

TEST(BladeSpeeds, OfABladeThatSweepsAlongItsNormalIsTheFeed) {
  std::vector<BladePose> poses;
  for (int i = 0; i <= 400; ++i) {
    // It slides along itself as well, which melts nothing more.
    const Frame frame{Vector3d(0.35 * i, 0, -0.35 * i), Vector3d::UnitX(), Vector3d::UnitY()};
    poses.push_back(straight(frame, 0.05 * i));
  }
  const BladeSpeeds speeds(poses);
  ASSERT_FALSE(speeds.empty());
  for (const Vector3d& p :
       {Vector3d(120, 0, -20), Vector3d(200, 5, -90), Vector3d(-50, 0, 30), Vector3d(500, 0, -500)})
    EXPECT_NEAR(speeds.at(p), 7, 1e-9);
  EXPECT_NEAR(speeds.range().first, 7, 1e-9);
  EXPECT_NEAR(speeds.range().second, 7, 1e-9);
}

TEST(BladeSpeeds, OfABladeThatTurnsGrowWithTheDistanceFromItsAxis) {
  // About y through the origin, 0.02 rad/s; also farther than half a turn.
  for (const double whole : {0.6, 4.5}) {
    std::vector<BladePose> poses;
    const double omega = 0.02;
    for (int i = 0; i <= 2000; ++i) {
      const double t = whole / omega * i / 2000;
      const Eigen::AngleAxisd turn(omega * t, Vector3d::UnitY());
      poses.push_back(straight({Vector3d::Zero(), turn * Vector3d::UnitX(), Vector3d::UnitY()}, t, 100));
    }
    const BladeSpeeds speeds(poses);
    for (const double angle : {0.1, 0.3, 0.55, 0.9 * whole}) {
      for (const double radius : {160.0, 200.0, 280.0}) {
        const Vector3d p = Eigen::AngleAxisd(angle, Vector3d::UnitY()) * Vector3d(radius, 3, 0);
        EXPECT_NEAR(speeds.at(p), omega * radius, 2e-4 * omega * radius) << whole << " " << angle;
      }
    }
  }
}

TEST(BladeSpeeds, FollowTheTimeOfThePoses) {
  std::vector<BladePose> poses;
  double t = 0;
  for (int i = 0; i <= 300; ++i) {
    poses.push_back(straight({Vector3d(0, 0, i), Vector3d::UnitX(), Vector3d::UnitY()}, t));
    t += i < 150 ? 0.5 : 0.125;
  }
  const BladeSpeeds speeds(poses);
  EXPECT_NEAR(speeds.at(Vector3d(100, 0, 60)), 2, 1e-9);
  EXPECT_NEAR(speeds.at(Vector3d(100, 0, 240)), 8, 1e-9);
}

TEST(BladeSpeeds, NeedTwoPosesThatFormTheDesign) {
  std::vector<BladePose> poses{straight({}, 0)};
  EXPECT_TRUE(BladeSpeeds(poses).empty());
  EXPECT_THROW((void)BladeSpeeds(poses).at(Vector3d::Zero()), std::logic_error);
  EXPECT_EQ(speed_across(Vector3d::Zero(), Vector3d(3, 4, 0), 0, Vector3d::UnitX()), 0);
  EXPECT_NEAR(speed_across(Vector3d::Zero(), Vector3d(3, 4, 0), 2, 10 * Vector3d::UnitX()), 2, 1e-15);
}

}  // namespace
}  // namespace hotblade::pipeline
