// How meshes bend, against the surfaces that they stand for.
#include "pipeline/plan/sweep/surface_bend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "pipeline/plan/sweep/sweep_sections.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kSize_mm = 200;

// The mesh over a square of a height whose slopes in its middle are zero.
WasteSurface over_square(int cells, double side, const std::function<double(double, double)>& height) {
  const surface::DesignSurface design =
      grid_design("square", cells, cells, [&](double u, double v) -> Vector3d {
        const double x = kSize_mm * (u - 0.5), y = kSize_mm * (v - 0.5);
        return {x, y, height(x, y)};
      });
  return waste_surface(design.mesh, side);
}

SurfaceBend in_the_middle(const WasteSurface& surface) {
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    if (surface.points[i].norm() < surface.points[nearest].norm()) nearest = i;
  }
  EXPECT_LT(surface.points[nearest].norm(), 1e-6);
  return surface.bends.at(nearest);
}

TEST(SurfaceBends, AreThoseOfASaddleTowardsItsWaste) {
  for (const int cells : {20, 100, 200}) {
    for (const double side : {1.0, -1.0}) {
      const WasteSurface surface = over_square(
          cells, side, [](double x, double y) { return x * x / 300 - y * y / 120 + x * y / 400; });
      const SurfaceBend bend = in_the_middle(surface);
      const double up = surface.normals.front().z() > 0 ? 1 : -1;
      EXPECT_NEAR(bend.of(Vector3d::UnitX()), up * 2 / 300, 2e-4) << cells;
      EXPECT_NEAR(bend.of(Vector3d::UnitY()), -up * 2 / 120, 6e-4) << cells;
      const Vector3d askew = Vector3d(1, 1, 0).normalized();
      EXPECT_NEAR(bend.of(askew), up * (1.0 / 300 - 1.0 / 120 + 1.0 / 400), 4e-4) << cells;
    }
  }
}

TEST(SurfaceBends, AreThoseOfACylinderUpToItsBorder) {
  const double radius_mm = 150;
  const WasteSurface surface =
      over_square(40, 1, [&](double x, double) { return std::sqrt(radius_mm * radius_mm - x * x); });
  ASSERT_GT(surface.normals.front().z(), 0);
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const double x = surface.points[i].x();
    // The cells grow with the slope, and with them what chords leave of the bend.
    if (std::abs(x) > 60) continue;
    const Vector3d along = Vector3d(std::sqrt(radius_mm * radius_mm - x * x), 0, -x) / radius_mm;
    EXPECT_NEAR(surface.bends[i].of(along), -1 / radius_mm, 0.02 / radius_mm)
        << surface.points[i].transpose();
    EXPECT_NEAR(surface.bends[i].of(Vector3d::UnitY()), 0, 1e-4);
  }
}

TEST(SurfaceBends, OfAFoldAreNoSharperInFinerFacets) {
  constexpr double kFold_rad = 0.1;
  const auto bend_in = [&](int cells) {
    return in_the_middle(
               over_square(cells, 1,
                           [&](double x, double) { return -std::tan(kFold_rad / 2) * std::abs(x); }))
        .of(Vector3d::UnitX());
  };
  const double coarse = bend_in(40), fine = bend_in(200);  // cells of 5 mm and of 1 mm
  EXPECT_LT(std::abs(fine), 1.5 * std::abs(coarse));
  EXPECT_NEAR(std::abs(coarse), kFold_rad / 8, kFold_rad / 16);
}

TEST(SurfaceBends, OfFlatAndEmptyMeshesAreNone) {
  const WasteSurface flat = over_square(10, 1, [](double x, double y) { return 0.3 * x - 0.2 * y; });
  for (const SurfaceBend& bend : flat.bends) EXPECT_NEAR(bend.of({1, 2, 3}), 0, 1e-9);
  EXPECT_TRUE(surface_bends({}, {}, {}, {}, 4).empty());
}

}  // namespace
}  // namespace hotblade::pipeline
