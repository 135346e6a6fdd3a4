#include "pipeline/program/block_place.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

// A block that was turned about the vertical stands in axes of its own, and its corner is a corner of it.
TEST(StandingPlace, IsOfTheBlockItselfHoweverItIsTurned) {
  const Block block{{{-150, 40, -60}, Vector3d::UnitX(), Vector3d::UnitY()}, {300, 80, 120}};
  const robot::Pose unturned{{0, 0, 310}, Eigen::Quaterniond::Identity()};
  const BlockPlace as_planned = standing_place(block, unturned);
  EXPECT_EQ(as_planned.turned_rad, 0);
  EXPECT_TRUE(as_planned.corner.isApprox(Vector3d(-150, 40, 250), 1e-12));
  for (int degrees = -180; degrees <= 180; degrees += 15) {
    const double yaw = degrees * M_PI / 180;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
    const robot::Pose pose{{100, -50, 310}, turn};
    const BlockPlace place = standing_place(block, pose);
    EXPECT_TRUE(place.box.sizes().isApprox(block.size_mm, 1e-9)) << degrees;
    EXPECT_LE(std::abs(place.turned_rad), M_PI / 2 + 1e-9);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vector3d& corner : block.corners())
      nearest = std::min(nearest, (turn * corner + pose.p - place.corner).norm());
    EXPECT_LT(nearest, 1e-9) << degrees;
    // In the box's axes it is the one at the left, at the front and below.
    EXPECT_TRUE((Eigen::AngleAxisd(-place.turned_rad, Vector3d::UnitZ()) * place.corner)
                    .isApprox(place.box.min(), 1e-9));
    EXPECT_NEAR(place.corner.z(), block.height_above_table_mm(pose), 1e-9);
  }
}

}  // namespace
}  // namespace hotblade::pipeline
