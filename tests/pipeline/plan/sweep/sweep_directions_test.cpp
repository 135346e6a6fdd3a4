// Which planes a part of a design is too steep for.
#include "pipeline/plan/sweep/sweep_directions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "tests/pipeline/plan_design.hpp"

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

}  // namespace
}  // namespace hotblade::pipeline
