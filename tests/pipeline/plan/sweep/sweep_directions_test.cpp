// Which planes a part of a design is too steep for.
#include "pipeline/plan/sweep/sweep_directions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/pipeline/plan/extrusions.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

TEST(TooSteepShares, CountWhatLiesBehindAPartsSeams) {
  // Half of a vault so narrow that what comes nearer than 60 mm to it is most of the other half as well.
  const surface::DesignSurface design = grid_design("narrow", 40, 10, [](double u, double v) {
    return Vector3d(160 * u, 300 * v, 136 * std::sin(M_PI * u));
  });
  const WasteSurface whole = waste_surface(design.mesh, 1);
  const std::vector<SweepSeam> left{{Vector3d::UnitX(), 80}};
  const WasteSurface near = part_of(whole, left, 60);
  const std::vector<surface::PlaneFamily> planes{
      surface::parallel_about(design.mesh, Vector3d(0.82, 0, 0.57).normalized()),
      surface::parallel_about(design.mesh, Vector3d::UnitX())};
  const std::vector<double> behind = too_steep_shares(near, left, planes),
                            all = too_steep_shares(near, {}, planes);
  EXPECT_EQ(behind[0], 0);    // square to the half's mean slope
  EXPECT_GT(behind[1], 0.3);  // along the vault's foot
  EXPECT_GT(all[0], 0.2);
  // As of a mesh of the half alone.
  const surface::DesignSurface half = grid_design("half", 20, 10, [](double u, double v) {
    return Vector3d(80 * u, 300 * v, 136 * std::sin(M_PI_2 * u));
  });
  const std::vector<double> alone = too_steep_shares(waste_surface(half.mesh, 1), {}, planes);
  EXPECT_EQ(alone[0], 0);
  // Triangles at the seam count by three of their corners.
  EXPECT_NEAR(behind[1], alone[1], 0.02);
}

// The least share of the area that is too steep for planes along x, as placed, of those that turn or not.
double least_steep_along_x(const surface::DesignSurface& design, const Eigen::Isometry3d& placed,
                           bool turning) {
  std::vector<surface::PlaneFamily> along;
  for (const surface::PlaneFamily& planes : sweep_planes(design.mesh, {})) {
    const double x = std::abs(planes.normal(0).dot(placed.linear().col(0)));
    if (planes.turns() == turning && x < 1e-3) along.push_back(planes);
  }
  const std::vector<double> steep = too_steep_shares(waste_surface(design.mesh, 1), {}, along);
  return steep.empty() ? 1 : *std::min_element(steep.begin(), steep.end());
}

TEST(SweepPlanes, AlongAFoldAreNotTooSteepForEitherLeg) {
  // Nearer and nearer to what no parallel planes follow.
  for (const double turn : {1.3, M_PI_2, 1.9, 2.07}) {
    for (const double second : {80.0, 150.0, 300.0}) {
      const Eigen::Isometry3d placed = tilted_in_space();
      const surface::DesignSurface fold = extruded({35, turn, 300, second, 1000}, placed);
      EXPECT_EQ(least_steep_along_x(fold, placed, false), 0) << turn << " " << second;
    }
  }
}

TEST(SweepPlanes, AlongARoundTurnAboutAnAxisWhereParallelOnesAreTooSteep) {
  for (const double turn : {2.2, 2.6, 3.1}) {
    for (const bool hollow : {false, true}) {
      Fold round{50, turn, 0, 0, 700};
      round.hollow = hollow;
      const Eigen::Isometry3d placed = tilted_in_space();
      const surface::DesignSurface design = extruded(round, placed);
      EXPECT_GT(least_steep_along_x(design, placed, false), 0.02) << turn << hollow;
      bool beyond = false;  // farther than the arc's own axis, so that planes turn less than its normals
      for (const surface::PlaneFamily& planes : sweep_planes(design.mesh, {})) {
        if (!planes.turns() || std::abs(planes.axis().dot(placed.linear().col(0))) < 0.999) continue;
        const Vector3d away = (planes.centre() - placed.translation()).cross(placed.linear().col(0));
        beyond = beyond || (away.norm() > 40 &&
                            too_steep_shares(waste_surface(design.mesh, 1), {}, std::vector{planes})[0] == 0);
      }
      EXPECT_TRUE(beyond) << turn << hollow;
    }
  }
}

}  // namespace
}  // namespace hotblade::pipeline
