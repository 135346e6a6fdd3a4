#include "pipeline/plan/ribs/target.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

// A plane that rises along x (the sweep) by `slope` and is level along y.
surface::DesignSurface ramp(double slope) {
  return grid_design("ramp", 8, 8, [slope](double u, double v) {
    return Eigen::Vector3d(300 * u, 400 * v, 300 * u * std::tan(slope));
  });
}

TargetReport targets_of(const surface::DesignSurface& design, const Settings& settings) {
  surface::SliceOptions options;
  options.normal = Eigen::Vector3d::UnitX();
  return make_targets(slice(design, options), settings);
}

TEST(MakeTargets, MovesTheTargetByHalfTheBandAlongTheDesignsNormal) {
  for (const double slope : {0.0, 0.05, 0.3}) {
    const TargetReport report = targets_of(ramp(slope), along_x());
    ASSERT_EQ(report.chains.size(), 1u);
    const ChainTarget& chain = report.chains.front();
    EXPECT_GT(chain.y.z(), 0.99) << "the waste is above";
    // Distance of the blade's centre line from the design's plane: half of kerf + width sin(slope).
    const Eigen::Vector3d normal(-std::sin(slope), 0, std::cos(slope));
    for (const RibTarget& rib : chain.ribs) {
      for (const Eigen::Vector2d& q : rib.points) {
        const Eigen::Vector3d p = chain.plane(rib.offset_mm).point(q.x(), q.y());
        EXPECT_NEAR(p.dot(normal), 0.5 * (1.0 + 8.0 * std::sin(slope)), 1e-9) << slope;
      }
    }
  }
}

TEST(MakeTargets, PutsTheWasteWhereKeepSays) {
  const std::pair<Keep, double> cases[] = {
      {Keep::kBelow, 1}, {Keep::kAbove, -1}, {Keep::kBack, 1}, {Keep::kFront, -1}};
  for (const auto& [keep, side] : cases) {
    Settings settings = along_x();
    settings.design.keep = keep;
    const TargetReport report = targets_of(ramp(0), settings);  // face normals point up
    ASSERT_EQ(report.chains.size(), 1u) << name(keep);
    EXPECT_GT(side * report.chains.front().y.z(), 0.99) << name(keep);
  }
}

TEST(MakeTargets, RefusesKeepBelowOnAnUprightWall) {
  const auto wall =
      grid_design("wall", 8, 8, [](double u, double v) { return Eigen::Vector3d(300 * u, 0, 400 * v); });
  const TargetReport report = targets_of(wall, along_x());
  EXPECT_TRUE(report.chains.empty());
  ASSERT_EQ(report.refusals.size(), 1u);
  EXPECT_NE(
      describe(report.refusals.front()).find("design.keep = \"below\" says nothing about an upright surface"),
      std::string::npos);
}

TEST(MakeTargets, LeavesOutRibsSteeperThanTheBladeCanFollow) {
  const TargetReport report = targets_of(ramp(1.2), along_x());
  EXPECT_TRUE(report.chains.empty());
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings.front().find("limit 60"), std::string::npos) << report.warnings.front();
}

TEST(Resample, SpacesPointsEvenlyBetweenTheShares) {
  RibTarget rib;
  for (int i = 0; i <= 10; ++i) {
    rib.points.emplace_back(i * i, 0);
    rib.s.push_back(i * i);
  }
  const auto points = resample(rib, 0.25, 0.75, 11);
  for (int i = 0; i <= 10; ++i) EXPECT_NEAR(points[static_cast<std::size_t>(i)].x(), 25 + 5 * i, 1e-12);
}

}  // namespace
}  // namespace hotblade::pipeline
