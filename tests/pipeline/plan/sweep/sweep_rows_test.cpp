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

}  // namespace
}  // namespace hotblade::pipeline
