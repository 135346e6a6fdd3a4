// Designs of many blocks in rows: the planes that take the fewest.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/plan/sweep/sweep_directions.hpp"
#include "pipeline/plan/sweep/sweep_layout.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

// What blocks are not large enough for counts twice, as it takes one more at least.
std::size_t strips_in_rows(const surface::DesignSurface& design, std::vector<surface::PlaneFamily> planes) {
  const Settings settings;
  const WatchSweeps watch = [] {};
  const PartFitter fitter(settings, watch);
  const SweepLayouts layouts(design.mesh, waste_surface(design.mesh, 1), std::move(planes), settings, fitter);
  const Layout rows = layouts.in_rows();
  std::size_t strips = 0;
  for (const PartFit& fit : rows.fits) strips += fit.holds() ? 1 : 2;
  return strips;
}

void expect_fewest(const surface::DesignSurface& design) {
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

TEST(SweepRows, AreInThePlanesThatTakeTheFewestStrips) {
  expect_fewest(grid_design("vault", 30, 16, [](double u, double v) -> Vector3d {
    const double a = std::numbers::pi * (v - 0.5);
    return {9000 * u, 2500 * std::sin(0.8 * a), 2500 * std::cos(0.8 * a)};
  }));
  expect_fewest(grid_design("swell on a slant", 30, 24, [](double u, double v) -> Vector3d {
    const double x = 6400 * u, y = 5200 * v + 0.4 * x;
    return {x, y, 0.2 * x + 700 * std::sin(3 * u) * std::cos(4 * v)};
  }));
}

}  // namespace
}  // namespace hotblade::pipeline
