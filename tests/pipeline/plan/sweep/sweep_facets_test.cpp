// What facets leave for a smooth cut, against spheres in facets of known size.
#include "pipeline/plan/sweep/sweep_facets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kRadiusMm = 5000, kSizeMm = 1000;

WasteSurface sphere_in_facets(int facets, double radius_mm) {
  const surface::DesignSurface design =
      grid_design("sphere", facets, facets, [&](double u, double v) -> Vector3d {
        const double x = kSizeMm * (u - 0.5), y = kSizeMm * (v - 0.5);
        return {x, y, std::sqrt(radius_mm * radius_mm - x * x - y * y) - radius_mm};
      });
  return waste_surface(design.mesh, 1);
}

TEST(SweepFacets, LeaveHalfOfWhatASphereRisesAboveThem) {
  for (const int facets : {8, 16, 32}) {
    const double leg_mm = kSizeMm / facets;
    // The arc over the longest edge of a right triangle.
    const double rise_mm = 2 * leg_mm * leg_mm / (8 * kRadiusMm);
    const FacetRise found = smooth_over_facets(sphere_in_facets(facets, kRadiusMm), {});
    EXPECT_NEAR(found.off_mm, 0.5 * rise_mm, 0.05 * rise_mm) << facets;
    EXPECT_NEAR(found.facet_mm, leg_mm, 0.02 * leg_mm);
  }
}

TEST(SweepFacets, LeaveNothingOfAPlane) {
  EXPECT_LT(smooth_over_facets(sphere_in_facets(8, 1e9), {}).off_mm, 1e-4);
  EXPECT_EQ(smooth_over_facets({}, {}).off_mm, 0);
}

TEST(SweepFacets, AreThoseBehindTheSeamsAlone) {
  const std::vector<SweepSeam> seams{{Vector3d::UnitX(), -kSizeMm}};  // the design lies in front of it
  EXPECT_EQ(smooth_over_facets(sphere_in_facets(8, kRadiusMm), seams).off_mm, 0);
}

}  // namespace
}  // namespace hotblade::pipeline
