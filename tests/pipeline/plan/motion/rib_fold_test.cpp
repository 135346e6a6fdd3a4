#include "pipeline/plan/motion/rib_fold.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "elastica/blade/clamp_margin.hpp"
#include "elastica/blade/stability.hpp"
#include "pipeline/plan/motion/motion.hpp"
#include "pipeline/plan/motion/rib_poses.hpp"
#include "pipeline/plan/ribs/rib_spline.hpp"
#include "pipeline/plan/sweep/sweep_search.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

constexpr double kFarMm = 2;

// The first strip that the search hands over.
StripPlan first_strip(const surface::DesignSurface& design, const Settings& settings) {
  std::vector<StripPlan> strips;
  const auto take = [&](const SweptPlan& swept) -> SweepVerdict {
    if (strips.empty()) strips = swept.strips;
    return {true, {}};
  };
  (void)search_sweeps(design, settings, {take, take});
  if (strips.empty()) throw std::runtime_error("no strip");
  return strips.front();
}

// One wave across the ribs, as long as a blade can just hold.
surface::DesignSurface wave(double rise_mm) {
  return grid_design("wave", 60, 30, [=](double u, double v) -> Eigen::Vector3d {
    return {300 * v, 500 * u, rise_mm * std::cos(2 * std::numbers::pi * 1.3 * u)};
  });
}

TEST(RibFold, OfABladeThatIsHardlyBentIsFar) {
  const Settings settings = along_x();
  const StripPlan strip = first_strip(cylinder_design(), settings);
  EXPECT_EQ(rib_fold_mm(strip, settings.machine, kFarMm), kFarMm);
}

TEST(RibFold, IsTheSmallestOfAWideSearchAtTheRibsAndBetween) {
  const Settings settings = along_x();
  const StripPlan strip = first_strip(wave(22), settings);
  const RibSpline spline(strip.ribs);
  double least_mm = 20;
  for (std::size_t i = 0; i + 1 < strip.ribs.size(); ++i) {
    for (int k = 0; k <= 4; ++k) {
      const double offset = std::lerp(strip.ribs[i].offset_mm, strip.ribs[i + 1].offset_mm, k / 4.0);
      const elastica::Elastica rib = from_mid_state(spline.mid_at(offset));
      const elastica::Elastica blade = extended(rib, strip.blade_length_mm, strip.share_a);
      least_mm = std::min(least_mm, elastica::clamp_margin(blade, {20, 0}).fold_mm);
    }
  }
  EXPECT_NEAR(rib_fold_mm(strip, settings.machine, 20), least_mm, 1e-3);
  const double half_mm = least_mm / 2, twice_mm = 2 * least_mm;
  EXPECT_EQ(rib_fold_mm(strip, settings.machine, half_mm), half_mm);
  EXPECT_NEAR(rib_fold_mm(strip, settings.machine, twice_mm), least_mm, 1e-3);
}

TEST(RibFold, IsNoneWhereAShapeDoesNotHold) {
  const Settings settings = along_x();
  StripPlan strip = first_strip(wave(22), settings);
  elastica::Elastica& rib = strip.ribs[2].elastica;
  const auto margin = [&] {
    return elastica::stability_margin(extended(rib, strip.blade_length_mm, strip.share_a));
  };
  ASSERT_GT(margin(), 0);
  for (int i = 0; i < 20 && margin() > 0; ++i) {
    rib.lambda1 *= 1.2;
    rib.lambda2 *= 1.2;
  }
  ASSERT_LE(margin(), 0);
  for (const double far_mm : {0.5, 2.0, 20.0}) EXPECT_EQ(rib_fold_mm(strip, settings.machine, far_mm), 0);
}

TEST(RibFold, IsNearlyThatOfTheMotion) {
  const Settings settings = along_x();
  const StripPlan strip = first_strip(wave(22), settings);
  const double rib_mm = rib_fold_mm(strip, settings.machine, 20);
  const BladeMotion motion = move_blade(strip, settings);
  EXPECT_LE(motion.facts.smallest_fold_mm, 1.001 * rib_mm);
  EXPECT_GE(motion.facts.smallest_fold_mm, 0.5 * rib_mm);
}

TEST(RibPoses, AreTheRibsAndQuartersOfTheGaps) {
  const Settings settings = along_x();
  const StripPlan strip = first_strip(cylinder_design(), settings);
  const std::vector<BladePose> poses = rib_poses(strip, settings.machine);
  ASSERT_EQ(poses.size(), 4 * (strip.ribs.size() - 1) + 1);
  for (std::size_t i = 0; i < strip.ribs.size(); ++i) {
    const elastica::Elastica blade = extended(strip.ribs[i].elastica, strip.blade_length_mm, strip.share_a);
    EXPECT_NEAR(poses[4 * i].blade.kappa, blade.kappa, 1e-9);
    EXPECT_NEAR(poses[4 * i].blade.length, strip.blade_length_mm, 1e-9);
    EXPECT_NEAR((poses[4 * i].frame.origin - strip.plane(strip.ribs[i].offset_mm).origin).norm(), 0, 1e-9);
  }
}

}  // namespace
}  // namespace hotblade::pipeline
