#include "pipeline/program/block.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

std::mt19937_64& random_bits() {
  static std::mt19937_64 bits(11);
  return bits;
}

double between(double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random_bits());
}

Vector3d random_point(double size) {
  return {between(-size, size), between(-size, size), between(-size, size)};
}

Frame random_frame() {
  const Vector3d x = random_point(1).normalized();
  return {random_point(500), x, x.cross(random_point(1)).normalized()};
}

Block random_block() {
  return {random_frame(), {between(10, 900), between(10, 900), between(10, 900)}};
}

TEST(Block, ContainsMixturesOfItsCornersAndNothingBeyondAFace) {
  for (int i = 0; i < 200; ++i) {
    const Block block = random_block();
    const auto corners = block.corners();
    const double u = between(0, 1), v = between(0, 1), w = between(0, 1);
    const Vector3d inside = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]) +
                            w * (corners[4] - corners[0]);
    EXPECT_TRUE(block.contains(inside));
    EXPECT_EQ(block.distance_mm(inside), 0);
    const Vector3d above = inside + (1 - w) * block.size_mm.z() * block.frame.normal();
    EXPECT_FALSE(block.contains(above + 0.1 * block.frame.normal()));
    EXPECT_NEAR(block.distance_mm(above + 7 * block.frame.normal()), 7, 1e-9);
  }
}

// Against the nearest of many points of the box: never nearer than the distance, and it is nearly reached.
TEST(Block, IsAsFarAsItsNearestPoint) {
  for (int i = 0; i < 40; ++i) {
    const Block block = random_block();
    const Vector3d p = block.frame.origin + random_point(2000);
    double nearest = std::numeric_limits<double>::infinity();
    constexpr int kSteps = 40;
    for (int a = 0; a <= kSteps; ++a)
      for (int b = 0; b <= kSteps; ++b)
        for (int c = 0; c <= kSteps; ++c) {
          const Vector3d share = Vector3d(a, b, c) / kSteps;
          const Vector3d q = share.cwiseProduct(block.size_mm);
          nearest = std::min(nearest, (block.frame.point(q.x(), q.y(), q.z()) - p).norm());
        }
    const double step = block.size_mm.norm() / kSteps / 2;
    EXPECT_LE(block.distance_mm(p), nearest + 1e-9);
    EXPECT_GE(block.distance_mm(p), nearest - step);
  }
}

TEST(Block, SeenFromAPlaneIsAsFarFromThePlanesPointsAsInSpace) {
  for (int i = 0; i < 200; ++i) {
    const Block block = random_block();
    const Frame plane = random_frame();
    const Block seen = block.seen_from(plane);
    const double u = between(-1500, 1500), v = between(-1500, 1500);
    EXPECT_NEAR(seen.distance_mm({u, v, 0}), block.distance_mm(plane.point(u, v)), 1e-9);
  }
}

TEST(Block, StandsAsHighAsItsLowestCorner) {
  const Block block{{{0, 0, -20}, Vector3d::UnitX(), Vector3d::UnitY()}, {300, 200, 100}};
  robot::Pose to_cell;
  to_cell.p = {5, 6, 170};
  EXPECT_NEAR(block.height_above_table_mm(to_cell), 150, 1e-12);
  // Turned on its side, the far end of x is the lowest.
  to_cell.q = Eigen::Quaterniond(Eigen::AngleAxisd(1.5707963267948966, Vector3d::UnitY()));
  EXPECT_NEAR(block.height_above_table_mm(to_cell), 170 - 300, 1e-9);
}

}  // namespace
}  // namespace hotblade::pipeline
