// Designs of many blocks in rows: the planes that take the fewest.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/plan/sweep/sweep_directions.hpp"
#include "pipeline/plan/sweep/sweep_layout.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

// What blocks are not large enough for counts twice, as it takes one more at least.
std::size_t strips_in_rows(const surface::DesignSurface& design,
                           const std::vector<surface::PlaneFamily>& planes) {
  const Settings settings;
  const WatchSweeps watch = [] {};
  const PartFitter fitter(settings, watch);
  const SweepLayouts layouts(design.mesh, waste_surface(design.mesh, 1), planes, settings, fitter);
  std::vector<PlanesTried> tried;
  const Layout rows = layouts.in_rows(tried);
  // The planes that were weighed are told, the chosen ones first.
  EXPECT_FALSE(tried.empty());
  EXPECT_EQ(tried.front().planes.normal(0), rows.planes.normal(0));
  std::size_t strips = 0, parallel = 0;
  for (const surface::PlaneFamily& one : planes) parallel += one.turns() ? 0 : 1;
  EXPECT_LE(tried.size(), parallel);
  for (const PlanesTried& other : tried) {
    EXPECT_TRUE(other.of_rows());
    if (other.strips_in_rows > 0)
      EXPECT_GE(other.strips_in_rows, tried.front().strips_in_rows);
    else
      EXPECT_GE(other.blocks, static_cast<double>(tried.front().strips_in_rows)) << "it might take fewer";
  }
  for (const PartFit& fit : rows.fits) strips += fit.holds() ? 1 : 2;
  return strips;
}

TEST(SweepRows, AreInThePlanesThatTakeTheFewestStrips) {
  const surface::DesignSurface design =
      grid_design("swell on a slant", 30, 24, [](double u, double v) -> Vector3d {
        const double x = 6400 * u, y = 5200 * v + 0.4 * x;
        return {x, y, 0.2 * x + 700 * std::sin(3 * u) * std::cos(4 * v)};
      });
  const std::vector<surface::PlaneFamily> all = sweep_planes(design.mesh, {});
  std::size_t fewest = std::numeric_limits<std::size_t>::max(), most = 0;
  for (const surface::PlaneFamily& planes : all) {
    if (planes.turns()) continue;
    const std::size_t strips = strips_in_rows(design, {planes});
    fewest = std::min(fewest, strips);
    most = std::max(most, strips);
  }
  EXPECT_EQ(strips_in_rows(design, all), fewest);
  EXPECT_GT(most, fewest) << "all planes are alike";
}

surface::DesignSurface swell(double length_mm, double width_mm) {
  return grid_design("swell", 30, 24, [=](double u, double v) -> Vector3d {
    return {length_mm * u, width_mm * v, 40 * std::sin(3 * u) * std::cos(2 * v)};
  });
}

Layout rows_of(const surface::DesignSurface& design, double blade_mm) {
  Settings settings;
  settings.blade.free_lengths_mm = {blade_mm};
  const WatchSweeps watch = [] {};
  const PartFitter fitter(settings, watch);
  std::vector<PlanesTried> tried;
  return SweepLayouts(design.mesh, waste_surface(design.mesh, 1), sweep_planes(design.mesh, {}), settings,
                      fitter)
      .in_rows(tried);
}

// Rows were cut at samples 40 mm apart, and then made narrower by as much as their parts were too long.
TEST(SweepRows, OfABladeThatReachesOverLessThanSamplesAreApart) {
  constexpr double kReach_mm = 44, kSeams_mm = 16;
  const Layout rows = rows_of(swell(900, 600), kReach_mm + 106);
  EXPECT_GE(static_cast<double>(rows.parts.size()), 600 / (kReach_mm - kSeams_mm));
  EXPECT_LT(rows.parts.size(), 80U);
  for (const PartFit& fit : rows.fits) EXPECT_TRUE(fit.holds());
}

TEST(SweepRows, AreNotLaidWhereTheyWouldBeMoreThanIsEverPlanned) {
  const Layout rows = rows_of(swell(9000, 6000), 18 + 106);
  EXPECT_TRUE(rows.parts.empty());
  EXPECT_GT(rows.grid.count(), kMostStrips);
}

}  // namespace
}  // namespace hotblade::pipeline
