#include "elastica/blade/blade_batch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "elastica/blade/stability.hpp"

namespace hotblade::elastica {
namespace {

constexpr StiffnessRatios kStrip{256, 1.54};

std::vector<Simd> instruction_sets() {
  std::vector<Simd> sets;
  for (const Simd simd : {Simd::kBaseline, Simd::kAvx2, Simd::kAvx512}) {
    if (supported(simd)) sets.push_back(simd);
  }
  return sets;
}

// Stable and lost ones, from hardly bent to winding, some so fast that no batch takes them, and the
// degenerate: straight, circular, compressed at and about the load that buckles them, pulled taut.
std::vector<Elastica> blades(std::size_t count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(-1, 1), exponent(-6, 2);
  std::vector<Elastica> all{{0, 0, 0.3, 0, 0, 0, 500},   {10, 20, -2, 0.004, 0, 0, 700},
                            {0, 0, 0, 0, 39, 0, 1},      {0, 0, 0, 0, 39.47, 0, 1},
                            {0, 0, 1, 0, -60, -90, 1},   {0, 0, 0, 1e-9, 1e-9, 1e-9, 1},
                            {0, 0, 3, 1e-7, 0, 1e-6, 1}, {5, 5, 0.1, 40, 0, 0, 1},
                            {5, 5, 0.1, 3, 500, 400, 1}, {1, 1, 1, 2.5, 0, 0, 1}};
  while (all.size() < count) {
    const double length = 1000 * (1.1 + u(random)), size = std::pow(10, exponent(random)) / length;
    all.push_back({100 * u(random), 100 * u(random), 4 * u(random), 3 * u(random) * size,
                   30 * u(random) * size / length, 30 * u(random) * size / length, length});
  }
  return all;
}

TEST(BladeBatch, PointsAreThoseOfOneCurveOnEveryInstructionSet) {
  const std::vector<Elastica> all = blades(400);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(-0.5, 1.5);
  std::vector<double> s;
  for (const Elastica& e : all) s.push_back(e.length * share(random));
  s[3] = 0;
  for (const Simd simd : instruction_sets()) {
    std::vector<CurvePoint> points(all.size());
    points_at(all, s, points, simd);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const CurvePoint p = point_at(all[i], s[i]);
      const double rate = 1 + all[i].length * std::abs(p.kappa);
      EXPECT_NEAR((points[i].position() - p.position()).norm(), 0, 1e-11 * all[i].length) << i;
      EXPECT_NEAR(points[i].theta, p.theta, 1e-11 * rate) << i;
      EXPECT_NEAR(points[i].kappa * all[i].length, p.kappa * all[i].length, 1e-9 * rate) << i;
    }
  }
}

TEST(BladeBatch, PartsAreThePointsAtTheirArcLengths) {
  const std::vector<Elastica> all = blades(100);
  constexpr std::size_t kPoints = 17;
  std::vector<Part> parts;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double at = static_cast<double>(i) / static_cast<double>(all.size());
    parts.push_back({(at - 0.3) * all[i].length, (1.2 - 0.5 * at) * all[i].length});
  }
  parts[4] = {0, 0};
  for (const Simd simd : instruction_sets()) {
    const PartPoints points = sample_parts(all, parts, kPoints, simd);
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t k = 0; k < kPoints; ++k) {
        const double s =
            parts[i].first + (parts[i].last - parts[i].first) * static_cast<double>(k) / (kPoints - 1);
        const CurvePoint p = point_at(all[i], s);
        const std::size_t n = i * kPoints + k;
        EXPECT_NEAR((points.at(i, k) - p.position()).norm(), 0, 1e-11 * all[i].length) << i << " " << k;
        EXPECT_NEAR((Eigen::Vector2d(points.cos[n], points.sin[n]) - p.tangent()).norm(), 0, 1e-10) << i;
        EXPECT_NEAR(points.turn[n], p.theta - all[i].theta, 1e-10 * (1 + std::abs(p.theta))) << i;
        EXPECT_NEAR(points.curvature[n] * all[i].length, p.kappa * all[i].length,
                    1e-9 * (1 + std::abs(p.kappa) * all[i].length));
      }
    }
  }
}

TEST(BladeBatch, PlacesAreTheSameBitsWithoutDirections) {
  const std::vector<Elastica> all = blades(203);
  std::vector<Part> parts;
  for (std::size_t i = 0; i < all.size(); ++i)
    parts.push_back({0.1 * static_cast<double>(i % 5) * all[i].length,
                     (1.3 - 0.01 * static_cast<double>(i)) * all[i].length});
  for (const Simd simd : instruction_sets()) {
    for (const std::size_t points : {2U, 5U, 33U, 500U}) {
      const PartPoints with = sample_parts(all, parts, points, simd);
      const PartPlaces places = sample_places(all, parts, points, simd);
      for (std::size_t i = 0; i < all.size(); ++i) {
        // In company and alone.
        const PartPlaces one = sample_places({&all[i], 1}, {&parts[i], 1}, points, simd);
        for (std::size_t k = 0; k < points; ++k) {
          ASSERT_EQ(places.at(i, k), with.at(i, k)) << i << " " << k << " of " << points;
          ASSERT_EQ(places.at(i, k), one.at(0, k)) << i << " " << k << " of " << points;
        }
      }
    }
  }
}

TEST(BladeBatch, CurvatureIsTheLargestFromAsManyPointsAsItAsksFor) {
  const std::vector<Elastica> all = blades(2000);
  constexpr std::size_t kMost = 97;
  std::size_t fewest = kMost, most = 0;
  for (const Elastica& e : all) {
    const std::size_t points = curvature_points({&e, 1}, kMost);
    fewest = std::min(fewest, points);
    most = std::max(most, points);
    const Part whole{0, e.length};
    const double largest = ElasticaCurve(e).max_abs_curvature();
    EXPECT_NEAR(max_abs_curvature(e, sample_parts({&e, 1}, {&whole, 1}, points), 0), largest,
                1e-9 * (largest + 1 / e.length));
  }
  EXPECT_EQ(fewest, 9U);
  EXPECT_GT(most, 33U);
  EXPECT_EQ(curvature_points(all, kMost), most);
  EXPECT_EQ(curvature_points({}, kMost), 9U);
}

TEST(BladeBatch, MarginsAreThoseOfOneBladeOnEveryInstructionSet) {
  const std::vector<Elastica> all = blades(4000);
  for (const Simd simd : instruction_sets()) {
    std::vector<double> margins(all.size());
    stability_margins(all, margins, simd);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double one = stability_margin(all[i]);
      EXPECT_NEAR(margins[i], one, 1e-9 * (1 + std::abs(one))) << i << " " << static_cast<int>(simd);
    }
  }
}

TEST(BladeBatch, DroopsAreThoseOfOneBladeOnEveryInstructionSet) {
  const std::vector<Elastica> all = blades(2000);
  std::mt19937_64 random(2);
  std::vector<DroopLoad> loads;
  for (const Elastica& e : all) {
    const std::size_t a = random() % (kGravityCells + 1), b = random() % (kGravityCells + 1);
    loads.push_back({1 / std::pow(e.length, 3), std::min(a, b), std::max(a, b)});
  }
  std::size_t stable = 0, lost = 0;
  for (const Simd simd : instruction_sets()) {
    std::vector<DroopReach> reach(all.size());
    droops(all, loads, kStrip, reach, simd);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Droop one = droop(all[i], loads[i].load, kStrip);
      double shift = 0, twist = 0;
      for (std::size_t k = loads[i].first; k <= loads[i].last; ++k) {
        shift = std::max(shift, std::abs(one.shift[k]));
        twist = std::max(twist, std::abs(one.twist[k]));
      }
      EXPECT_EQ(reach[i].stable, one.stable) << i;
      ++(one.stable ? stable : lost);
      if (!one.stable) continue;
      // A blade about to tip magnifies rounding as it does its weight: a straight one sags by 1e-5 of its
      // length.
      const double share = 1e-9 * std::max(1.0, one.largest / (0.01 * all[i].length));
      EXPECT_NEAR(reach[i].shift, shift, share * (one.largest + 1e-12 * all[i].length)) << i;
      EXPECT_NEAR(reach[i].twist, twist, share * (one.largest_twist + 1e-12)) << i;
    }
  }
  EXPECT_GT(stable, 1000U);
  EXPECT_GT(lost, 10U);
}

TEST(BladeBatch, DroopProfilesAreThoseOfOneBladeOnEveryInstructionSet) {
  std::vector<Elastica> all = blades(500);
  // Winds too fast for the lanes.
  all.push_back({0, 0, 0, 2 * kBatchRate / 300, 0, 0, 300});
  std::vector<double> loads;
  for (const Elastica& e : all) loads.push_back(1 / std::pow(e.length, 3));
  std::size_t stable = 0;
  for (const Simd simd : instruction_sets()) {
    const std::vector<Droop> profiles = droop_profiles(all, loads, kStrip, simd);
    ASSERT_EQ(profiles.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Droop one = droop(all[i], loads[i], kStrip), &is = profiles[i];
      ASSERT_EQ(is.shift.size(), one.shift.size());
      ASSERT_EQ(is.twist.size(), one.twist.size());
      EXPECT_EQ(is.stable, one.stable) << i;
      if (!one.stable) continue;
      ++stable;
      // As above: a blade about to tip magnifies rounding.
      const double share = 1e-9 * std::max(1.0, one.largest / (0.01 * all[i].length)),
                   shift = share * (one.largest + 1e-12 * all[i].length),
                   twist = share * (one.largest_twist + 1e-12);
      for (std::size_t k = 0; k < one.shift.size(); ++k) {
        ASSERT_NEAR(is.shift[k], one.shift[k], shift) << i << ", node " << k;
        ASSERT_NEAR(is.twist[k], one.twist[k], twist) << i << ", node " << k;
      }
      EXPECT_NEAR(is.largest, one.largest, shift) << i;
      EXPECT_NEAR(is.largest_twist, one.largest_twist, twist) << i;
    }
  }
  EXPECT_GT(stable, 400U);
}

TEST(BladeBatch, ShiftsInThePlaneAreThoseOfOneBlade) {
  const std::vector<Elastica> all = blades(331);
  std::vector<Eigen::Vector2d> loads;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double turn = 0.7 * static_cast<double>(i);
    loads.emplace_back(Eigen::Vector2d(std::cos(turn), std::sin(turn)) / std::pow(all[i].length, 3));
  }
  for (const Simd simd : instruction_sets()) {
    const std::vector<PlaneShift> shifts = plane_shifts(all, loads, simd);
    ASSERT_EQ(shifts.size(), all.size());
    std::size_t stable = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (stability_margin(all[i]) <= 0.1) continue;  // a blade about to snap magnifies rounding
      ++stable;
      const PlaneShift one = plane_shift(all[i], loads[i]);
      ASSERT_EQ(shifts[i].shift.size(), one.shift.size());
      for (std::size_t k = 0; k < one.shift.size(); ++k)
        ASSERT_NEAR((shifts[i].shift[k] - one.shift[k]).norm(), 0, 1e-9 * one.largest) << i << ", node " << k;
      EXPECT_NEAR(shifts[i].largest, one.largest, 1e-9 * one.largest) << i;
      const PlaneShift alone = plane_shifts({&all[i], 1}, {&loads[i], 1}, simd).front();
      EXPECT_EQ(alone.shift, shifts[i].shift) << i;
    }
    EXPECT_GT(stable, 100U);
  }
}

TEST(BladeBatch, SplittingABatchChangesNoBit) {
  const std::vector<Elastica> all = blades(203);
  for (const Simd simd : instruction_sets()) {
    std::vector<double> together(all.size());
    std::vector<DroopReach> sag(all.size());
    const std::vector<DroopLoad> loads(all.size(), {1e-9, 0, kGravityCells});
    stability_margins(all, together, simd);
    droops(all, loads, kStrip, sag, simd);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::span<const Elastica> one(&all[i], 1);
      double margin = 0;
      DroopReach reach;
      stability_margins(one, {&margin, 1}, simd);
      droops(one, {&loads[i], 1}, kStrip, {&reach, 1}, simd);
      EXPECT_EQ(margin, together[i]) << i;
      EXPECT_EQ(reach.shift, sag[i].shift) << i;
      EXPECT_EQ(reach.twist, sag[i].twist) << i;
    }
  }
}

TEST(BladeBatch, RefusesWhatOneCurveRefuses) {
  std::vector<double> margin(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Elastica> bad{{0, 0, 0, nan, 0, 0, 1}}, good{{0, 0, 0, 1, 0, 0, 1}},
      wound{{0, 0, 0, 1e6, 0, 0, 1}};
  EXPECT_THROW(stability_margins(bad, margin), std::logic_error);
  EXPECT_THROW(stability_margins(good, {}), std::logic_error);
  EXPECT_THROW((void)sample_parts(wound, std::vector<Part>{{0, 1}}, 5), std::logic_error);
  EXPECT_THROW((void)sample_parts(good, std::vector<Part>{{0, 1}}, 1), std::logic_error);
  std::vector<DroopReach> reach(1);
  EXPECT_THROW(droops(good, std::vector<DroopLoad>{{1, 5, 300}}, kStrip, reach), std::logic_error);
  EXPECT_THROW(droops(good, std::vector<DroopLoad>{{nan, 0, 3}}, kStrip, reach), std::logic_error);
  EXPECT_THROW((void)plane_shifts(good, {}), std::logic_error);
  EXPECT_THROW((void)plane_shifts(good, std::vector<Eigen::Vector2d>{{nan, 0}}), std::logic_error);
  EXPECT_THROW((void)plane_shifts(bad, std::vector<Eigen::Vector2d>{{1, 0}}), std::logic_error);
  EXPECT_THROW((void)plane_shift(good[0], {1, 0}, CellMiddles{}), std::logic_error);
  EXPECT_THROW((void)droop_profiles(good, {}, kStrip), std::logic_error);
  EXPECT_THROW((void)droop_profiles(good, std::vector<double>{nan}, kStrip), std::logic_error);
  EXPECT_THROW((void)droop_profiles(good, std::vector<double>{1}, {0, 1}), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
