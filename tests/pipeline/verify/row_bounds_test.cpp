#include "pipeline/verify/row_bounds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kApart_mm = 0.2, kSwept_mm = 400;
constexpr std::size_t kSweptPoses = 501;

// A straight blade along y that goes 100 mm along x, its middle half in foam but at the first and last 40
// poses.
Program straight_sweep() {
  Program program = testing::vault_program();
  program.blade.density_kg_m3 = 0;
  Strip& strip = program.strips.front();
  const BladePose pattern = strip.poses.front();
  strip.poses.clear();
  for (std::size_t i = 0; i < kSweptPoses; ++i) {
    BladePose& pose = strip.poses.emplace_back(pattern);
    const double x = kApart_mm * static_cast<double>(i);
    pose.t = 0.03 * static_cast<double>(i);
    pose.heat = true;
    pose.frame = SharedFrame(Frame{{x, 0, 0}, Vector3d::UnitY(), Vector3d::UnitZ()});
    pose.blade = {0, 0, 0, 0, 0, 0, kSwept_mm};
    pose.a.p = {x, 0, 0};
    pose.b.p = {x, kSwept_mm, 0};
    pose.foam.reset();
    if (i >= 40 && i + 40 < kSweptPoses) pose.foam = {{100, 300}};
  }
  program.strips.resize(1);
  return program;
}

class RowBoundsTest : public ::testing::Test {
 protected:
  // Nearest to a place of the grid.
  [[nodiscard]] std::size_t vertex_at(double x, double y) const {
    const auto nearer = [&](const Vector3d& p, const Vector3d& q) {
      return std::hypot(p.x() - x, p.y() - y) < std::hypot(q.x() - x, q.y() - y);
    };
    const auto found = std::min_element(cut_.vertices.begin(), cut_.vertices.end(), nearer);
    return static_cast<std::size_t>(found - cut_.vertices.begin());
  }
  // The largest bound where one pose is off in the part at y.
  [[nodiscard]] double with_pose_off(std::size_t pose, double y, float off_mm) const {
    PartsOff off;
    for (std::size_t i = 0; i < kSweptPoses; ++i) {
      std::array<float, kBladeParts> parts{};
      if (i == pose) parts.at(static_cast<std::size_t>(y / kSwept_mm * kBladeParts)) = off_mm;
      off.add(parts);
    }
    return bounds_.with(off, program_.strips[0], 0, program_.blade.width_mm);
  }
  static std::size_t pose_at(double x) { return static_cast<std::size_t>(x / kApart_mm); }

  Program program_ = straight_sweep();
  SweptSurface cut_ = swept_surface(program_, 5);
  RowBounds bounds_{cut_, program_};
};

TEST_F(RowBoundsTest, APoseCountsWhereItsWidthAndItsPartAre) {
  bounds_.add(std::vector<std::size_t>{vertex_at(48, 210)}, 0.5);
  bounds_.add(std::vector<std::size_t>{vertex_at(80, 110)}, 0.1);
  EXPECT_EQ(with_pose_off(0, 0, 0), 0.5);
  // Rows lie 5 mm apart from 8 mm on. At the place, and as far as the rows beside it and the half width
  // beyond them.
  for (const double x : {48.0, 43.0, 53.0, 40.0, 56.0})
    EXPECT_NEAR(with_pose_off(pose_at(x), 210, 0.25F), 0.75, 1e-12) << x;
  // Elsewhere along the sweep or the blade another bound has it, or none.
  EXPECT_EQ(with_pose_off(pose_at(48), 110, 0.25F), 0.5);
  EXPECT_EQ(with_pose_off(pose_at(30), 210, 0.25F), 0.5);
  EXPECT_EQ(with_pose_off(pose_at(80), 210, 0.25F), 0.5);
  EXPECT_NEAR(with_pose_off(pose_at(80), 110, 0.75F), 0.85, 1e-12);
}

TEST_F(RowBoundsTest, WhatLiesBetweenVerticesHasTheirBound) {
  bounds_.add(std::vector<std::size_t>{vertex_at(30, 120), vertex_at(70, 130), vertex_at(50, 280)}, 0.3);
  for (const double x : {30.0, 50.0, 70.0}) {
    for (const double y : {120.0, 180.0, 280.0})
      EXPECT_NEAR(with_pose_off(pose_at(x), y, 0.25F), 0.55, 1e-12) << x << " " << y;
  }
}

TEST_F(RowBoundsTest, HotPosesBeyondTheEndsCountThere) {
  // Foam begins at 8 mm.
  bounds_.add(std::vector<std::size_t>{vertex_at(8, 210)}, 0.2);
  EXPECT_NEAR(with_pose_off(pose_at(5.5), 210, 0.25F), 0.45, 1e-12);
  EXPECT_EQ(with_pose_off(pose_at(0), 210, 0.25F), 0.2);
}

TEST_F(RowBoundsTest, OfNoStripIsNone) {
  EXPECT_EQ(RowBounds().with(PartsOff(), program_.strips[0], 0, 8), 0);
}

}  // namespace
}  // namespace hotblade::pipeline
