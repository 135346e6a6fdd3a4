#include "robot/blade/blade_section.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hotblade::robot {
namespace {

using elastica::Elastica;

// 8 x 0.5 mm of spring steel.
constexpr Blade kSpring{{8, 0.5, 190000, 1010}, 0.3, 1.5, 7900, 1};

TEST(BladeSection, StiffnessAndWeightAreThoseWorkedOutByHand) {
  EXPECT_NEAR(bending_stiffness_n_mm2(kSpring), 15833.33, 0.01);  // 190000 * 8 * 0.125 / 12
  EXPECT_NEAR(weight_n_mm(kSpring), 3.0989e-4, 1e-8);             // 31.6 g/m
  EXPECT_NEAR(1 / max_curvature_per_mm(kSpring), 70.54, 0.01);
  EXPECT_NEAR(stiffness_ratios(kSpring).upright, 256, 1e-9);
}

TEST(BladeSection, TorsionOfASquareBarIsSaintVenants) {
  // J = 0.1406 a^4 (Timoshenko and Goodier, table in art. 109), so G J / B = 0.1406 * 12 / (2 (1 + nu)).
  const Blade square{{2, 2, 200000, 1000}, 0.3, 1, 7900, 3};
  EXPECT_NEAR(stiffness_ratios(square).torsion, 0.1406 * 12 / 2.6, 0.005 * 0.65);
}

TEST(BladeLoads, OfABuckledBladeAreEulersAndPushInwards) {
  // One shallow wave between clamps on one line: y = a (1 - cos(2 pi x / l)), held by 4 pi^2 B / l^2.
  const double l = 600, amplitude = 2, wave = 2 * std::numbers::pi / l;
  const Elastica blade{0, 0, 0, amplitude * wave * wave, wave * wave, 0, l};
  const BladeLoads loads = blade_loads(blade, kSpring);
  EXPECT_NEAR(loads.force_n.x(),
              -4 * std::numbers::pi * std::numbers::pi * bending_stiffness_n_mm2(kSpring) / (l * l), 1e-9);
  EXPECT_EQ(loads.force_n.y(), 0);
  EXPECT_NEAR(loads.moment_a_n_mm, bending_stiffness_n_mm2(kSpring) * amplitude * wave * wave, 1e-9);
  EXPECT_NEAR(loads.moment_b_n_mm, loads.moment_a_n_mm, 1e-3 * loads.moment_a_n_mm);
}

TEST(BladeLoads, HoldTheWholeBladeInBalance) {
  const Elastica blade{10, -20, 0.4, 0.003, -2e-5, 1e-5, 500};
  const BladeLoads loads = blade_loads(blade, kSpring);
  const auto end = elastica::point_at(blade, blade.length);
  const Eigen::Vector2d arm(end.x - blade.x, end.y - blade.y);
  // The blade's moment at B balances the one at A and the force's about A. Moments on the blade are +B kappa
  // at B and -B kappa at A.
  const double force_moment = arm.x() * loads.force_n.y() - arm.y() * loads.force_n.x();
  EXPECT_NEAR(loads.moment_b_n_mm - loads.moment_a_n_mm + force_moment, 0,
              1e-6 * std::abs(loads.moment_a_n_mm));
}

TEST(BladeLoads, StressReachesTheLimitAtTheSmallestRadius) {
  const double kappa = max_curvature_per_mm(kSpring);
  const BladeLoads loads = blade_loads({0, 0, 0, -kappa, 0, 0, 100}, kSpring);
  EXPECT_NEAR(loads.stress_mpa, 1010 / 1.5, 1e-9);
  EXPECT_NEAR(loads.smallest_radius_mm, 1 / kappa, 1e-9);
  EXPECT_TRUE(std::isinf(blade_loads({0, 0, 0, 0, 0, 0, 100}, kSpring).smallest_radius_mm));
}

TEST(BladeSag, OfAStraightLevelBladeIsTheClampedBeams) {
  const BladeSag sag = blade_sag({0, 0, 0, 0, 0, 0, 1000}, kSpring, {0, 0, -1}, 0, 1000);
  const double upright = 256 * bending_stiffness_n_mm2(kSpring);
  EXPECT_NEAR(sag.droop_mm, weight_n_mm(kSpring) * 1e12 / (384 * upright), 1e-3 * sag.droop_mm);
  EXPECT_NEAR(sag.droop_mm, 0.2, 0.01);
  EXPECT_EQ(sag.in_plane_mm, 0);
  EXPECT_TRUE(sag.stable);
}

TEST(BladeSag, CountsOnlyThePartAskedFor) {
  const Elastica arc{0, 0, 0, 0.001, 0, 0, 1000};
  const BladeSag all = blade_sag(arc, kSpring, {0, 0, -1}, 0, 1000);
  const BladeSag end = blade_sag(arc, kSpring, {0, 0, -1}, 0, 100);
  EXPECT_LT(end.droop_mm, 0.3 * all.droop_mm);
  EXPECT_GT(end.droop_mm, 0);
}

TEST(BladeSag, InAnUprightPlaneIsMillimetres) {
  // A 20 x 0.5 mm strip, elasto-gravity length 371 mm: bending in a vertical plane it sags by millimetres.
  const Blade strip{{20, 0.5, 190000, 1010}, 0.3, 1.5, 7900, 1};
  const Elastica arch{0, 0, 0.7, -1.4 / 1500, 0, 0, 1500};
  const BladeSag upright = blade_sag(arch, strip, {0, -1, 0}, 0, 1500);
  EXPECT_GT(upright.in_plane_mm, 1);
  EXPECT_LT(upright.in_plane_mm, 30);
  EXPECT_EQ(upright.droop_mm, 0);
  // A plane tilted by 6 degrees carries a tenth of it.
  const BladeSag tilted = blade_sag(arch, strip, {0, -std::sin(0.1), -std::cos(0.1)}, 0, 1500);
  EXPECT_NEAR(tilted.in_plane_mm, std::sin(0.1) * upright.in_plane_mm, 1e-9 * upright.in_plane_mm);
}

}  // namespace
}  // namespace hotblade::robot
