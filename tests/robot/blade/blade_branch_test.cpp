#include "robot/blade/blade_branch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "elastica/blade/continuation.hpp"
#include "elastica/blade/stability.hpp"
#include "robot/blade/blade_check.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

using elastica::Elastica;
using testing::kBladeLength_mm;
using testing::sample_blade;

constexpr BladeLimits kLimits{1 / 70.0, 1, 0.02, 0};

Pose turned(const Eigen::Vector3d& p, double angle) {
  return {p, Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()))};
}

// Clamp B of a shape whose clamp A stands at the origin along x.
Pose end_of(const Elastica& e) {
  const elastica::ClampPair pair = elastica::clamps_of(e);
  return turned({pair.b.x, pair.b.y, 0}, pair.b.theta);
}

Elastica flat() {
  return {0, 0, 0, 0.26 / kBladeLength_mm, 0, 0, kBladeLength_mm};
}

TEST(BladeBranch, FollowsACircularArcAsItsEndsCloseIn) {
  BladeBranch branch(kBladeLength_mm, kLimits);
  for (int i = 0; i <= 100; ++i) {
    const double u = 0.13 + 0.9 * i / 100;
    const Waypoint w = testing::arc_waypoint(0, {10.0 * i, 5, 900}, u, 0.01 * i, false);
    ASSERT_TRUE(branch.move_to(w.a, w.b).held()) << i;
    // Tangents turn from +u to -u.
    EXPECT_NEAR(branch.shape().kappa, -2 * u / kBladeLength_mm, 1e-9);
    EXPECT_NEAR(branch.largest_curvature_per_mm(), 2 * u / kBladeLength_mm, 1e-9);
    EXPECT_NEAR(branch.exact_margin(), elastica::stability_margin(branch.shape()), 1e-3);
  }
}

TEST(BladeBranch, TheCurvatureBoundIsNeverBelowTheCurvatureAndIsReached) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  int reached = 0;
  for (int i = 0; i < 2000; ++i) {
    const double l = kBladeLength_mm;
    const Elastica e{5,
                     -3,
                     3 * unit(random),
                     4 * unit(random) / l,
                     30 * unit(random) / (l * l),
                     30 * unit(random) / (l * l),
                     l};
    const double largest = elastica::ElasticaCurve(e).max_abs_curvature(), bound = curvature_bound(e);
    constexpr double kRounding = 1e-9;  // of the bisection and the series
    ASSERT_GE(bound * (1 + kRounding), largest) << i;
    if (largest >= bound * (1 - kRounding)) ++reached;
  }
  // Many pass the direction of the force.
  EXPECT_GT(reached, 200);
  const Elastica arc{0, 0, 1, -0.01, 0, 0, kBladeLength_mm};
  EXPECT_DOUBLE_EQ(curvature_bound(arc), 0.01);
}

TEST(BladeBranch, TheShapeHoldsBothClampsToRounding) {
  BladeBranch branch(kBladeLength_mm, kLimits);
  Elastica planned = flat();
  for (int i = 0; i <= 60; ++i) {
    planned.kappa = (0.26 + 0.01 * i) / kBladeLength_mm;
    planned.lambda1 = 1e-8 * i;
    planned.lambda2 = -2e-7 * i;
    ASSERT_TRUE(branch.move_to(turned({0, 0, 0}, 0), end_of(planned)).held()) << i;
    const auto found = elastica::clamps_of(branch.shape()), wanted = elastica::clamps_of(planned);
    EXPECT_NEAR(found.b.x, wanted.b.x, 1e-7);
    EXPECT_NEAR(found.b.y, wanted.b.y, 1e-7);
    EXPECT_NEAR(found.b.theta, wanted.b.theta, 1e-9);
    EXPECT_NEAR(branch.shape().lambda2, planned.lambda2, 1e-12);
  }
}

TEST(BladeBranch, FindsTheSameShapesAgainOnTheWayBack) {
  BladeBranch branch(kBladeLength_mm, kLimits);
  std::vector<Elastica> forth;
  for (int i = 0; i <= 40; ++i) {
    const Waypoint w = testing::arc_waypoint(0, {0, 0, 900}, 0.13 + 0.02 * i, 0, false);
    ASSERT_TRUE(branch.move_to(w.a, turned(w.b.p + Eigen::Vector3d(0, 0.5 * i, 0), -0.13)).held() || i > 0);
    forth.push_back(branch.shape());
  }
  for (int i = 40; i >= 0; --i) {
    const Waypoint w = testing::arc_waypoint(0, {0, 0, 900}, 0.13 + 0.02 * i, 0, false);
    ASSERT_FALSE(branch.lost());
    branch.move_to(w.a, turned(w.b.p + Eigen::Vector3d(0, 0.5 * i, 0), -0.13));
    EXPECT_LT(bend_between(branch.shape(), forth[static_cast<std::size_t>(i)]), 1e-8) << i;
  }
}

// Random stable shapes near random stable shapes: what the margin may be assumed to change by.
TEST(BladeBranch, AMarginSinksByNoMoreThanAssumed) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  int stable = 0;
  double largest = 0;
  while (stable < 3000) {
    const Elastica e{0, 0, 0, 5 * any(random), 40 * any(random), 40 * any(random), 1};
    const double margin = elastica::stability_margin(e);
    if (!(margin > 0)) continue;
    ++stable;
    const double size = std::pow(10, -1.5 + any(random));
    Elastica near = e;
    near.kappa += size * any(random);
    near.lambda1 += size * any(random);
    near.lambda2 += size * any(random);
    const double force = std::hypot(near.lambda1, near.lambda2);
    const double sunk = elastica::stability_margin(near);
    if (sunk > kMarginBoundHolds) continue;
    largest = std::max(largest, (margin - sunk) / ((1 + 0.1 * force) * bend_between(e, near)));
  }
  EXPECT_LT(largest, kMarginPerBend);
  EXPECT_GT(largest, kMarginPerBend / 20) << "the bound is far from what happens";
}

TEST(BladeBranch, WhereItIsFarFromLimitsNoneIsMet) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> any(-1, 1);
  constexpr BladeLimits kUnit{4.5, 1, 1e-6, 0};
  int far = 0, near_limits = 0;
  double closest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 6000; ++i) {
    const Elastica e{0, 0, 0, 5 * any(random), 40 * any(random), 40 * any(random), 1};
    if (!(elastica::stability_margin(e) > kUnit.min_margin)) continue;
    BladeBranch branch(e, kUnit);
    if (!branch.move_to(turned({0, 0, 0}, 0), end_of(e)).held()) continue;
    const double size = std::pow(10, -1.5 + any(random));
    Elastica other = e;
    other.kappa += size * any(random);
    other.lambda1 += size * any(random);
    other.lambda2 += size * any(random);
    if (!branch.far_from_limits(turned({0, 0, 0}, 0), end_of(other))) {
      ++near_limits;
      continue;
    }
    ++far;
    const double curvature = elastica::ElasticaCurve(other).max_abs_curvature();
    ASSERT_LE(curvature, kUnit.max_curvature_per_mm) << i;
    ASSERT_GE(elastica::stability_margin(other), kUnit.min_margin) << i;
    closest = std::min(closest, 1 - curvature / kUnit.max_curvature_per_mm);
  }
  EXPECT_GE(far, 500);
  EXPECT_GE(near_limits, 200);
  EXPECT_LT(closest, 0.05) << "the bound is far from what happens";
}

TEST(BladeBranch, AStraightBladeIsTakenFreeOfForceAndLeavesToItsClampsSide) {
  for (const double side : {1.0, -1.0}) {
    BladeBranch branch(kBladeLength_mm, {1 / 70.0, 1, 0.02, 1e-3 * std::sqrt(3)});
    const auto arc = [&](double u) { return testing::arc_waypoint(0, {0, 0, 900}, side * u, 0, false); };
    bool was_taut = false;
    for (int i = 0; i <= 200; ++i) {
      const double u = 0.13 * std::abs(i - 100) / 100;
      const Waypoint w =
          u > 0 ? arc(u) : Waypoint{0, false, turned({-400, 0, 900}, 0), turned({400, 0, 900}, 0)};
      const BladeFinding found = branch.move_to(w.a, w.b);
      ASSERT_TRUE(found.held()) << i << " " << static_cast<int>(found.limit) << " " << found.value;
      was_taut = was_taut || branch.taut();
      EXPECT_NEAR(branch.shape().kappa, -2 * side * u / kBladeLength_mm, 1e-9) << i;
    }
    EXPECT_TRUE(was_taut);
  }
}

// What docs/controller-protocol.md says of code 16, for clients that want to know it beforehand.
TEST(BladeBranch, IsTautFromTheSlackThatTheProtocolGives) {
  const double l = kBladeLength_mm, start = 0.13;
  for (const auto& [a, b] : {std::pair{0.13, -0.13}, {0.2, -0.2}, {0.1, 0.1}, {0.2, 0.0}, {0.15, 0.05}}) {
    const double slack = 0.0114 * (a - b) * (a - b) + 0.0108 * (a + b) * (a + b);
    BladeBranch branch(l, {std::numeric_limits<double>::infinity(), -1e9, 0.02, 0});
    const auto move_to = [&](double ta, double tb, double chord) {
      return branch.move_to(turned({0, 0, 0}, ta), turned({chord, 0, 0}, tb)).limit;
    };
    const double flat_chord = l * std::sin(start) / start;
    for (int i = 0; i <= 100; ++i) {
      const double s = i / 100.0;
      ASSERT_EQ(move_to(start + s * (a - start), -start + s * (b + start),
                        flat_chord + s * (l * (1 - 1.5 * slack) - flat_chord)),
                Limit::kNone)
          << a << ' ' << b << ' ' << i;
    }
    double reached = 1.5;
    while (reached > 0.5 && move_to(a, b, l * (1 - reached * slack)) == Limit::kNone) reached -= 1e-3;
    EXPECT_EQ(move_to(a, b, l), Limit::kBladeReach);
    EXPECT_NEAR(reached, 1, 0.02) << a << ' ' << b;
  }
}

TEST(BladeBranch, AClampThatTurnsOnATautBladeIsOutOfReach) {
  BladeBranch branch(kBladeLength_mm, kLimits);
  const Waypoint w = testing::arc_waypoint(0, {0, 0, 900}, 0.13, 0, false);
  ASSERT_TRUE(branch.move_to(w.a, w.b).held());
  const BladeFinding found = branch.move_to(turned({-400, 0, 900}, 0.13), turned({400, 0, 900}, -0.13));
  EXPECT_EQ(found.limit, Limit::kBladeReach);
  EXPECT_EQ(branch.move_to(w.a, w.b).limit, Limit::kBladeReach) << "the blade is lost";
}

TEST(BladeCheck, NamesTheLimitOfEveryFinding) {
  const BladeCheckOptions options;
  const Waypoint start = testing::arc_waypoint(0, {0, 0, 900}, 0.13, 0, false);
  const auto after = [&](const Waypoint& w) {
    BladeCheck check(sample_blade(), options);
    EXPECT_EQ(check.next(start), Limit::kNone);
    return check.next(w);
  };
  EXPECT_EQ(BladeCheck(sample_blade(), options).next(testing::arc_waypoint(0, {0, 0, 900}, 0.3, 0, false)),
            Limit::kStartPose);
  Waypoint lifted = start;
  lifted.b.p.z() += 0.06;
  EXPECT_EQ(after(lifted), Limit::kBladePlane);
  Waypoint apart = start;
  apart.b.p.x() += 20;
  EXPECT_EQ(after(apart), Limit::kBladeReach);
  EXPECT_EQ(BladeCheck(sample_blade(), {true, 1, 100}).next(start), Limit::kBladeMargin);
  // E t kappa / 2 is 71 MPa at half a turn of 0.6 rad.
  ClampedBlade soft = sample_blade();
  soft.yield_strength_mpa = 30;
  BladeCheck yields(soft, options);
  EXPECT_EQ(yields.next(start), Limit::kNone);
  EXPECT_EQ(yields.next(testing::arc_waypoint(0, {0, 0, 900}, 0.6, 0, false)), Limit::kBladeYield);
}

TEST(BladeCheck, WithoutTheEquilibriumNothingIsCheckedAndNoShapeIsKnown) {
  BladeCheck check(sample_blade(), {false, 1, 1});
  EXPECT_EQ(check.next(testing::arc_waypoint(0, {0, 0, 900}, 0.6, 0, false)), Limit::kNone);
  EXPECT_FALSE(check.shape());
  EXPECT_FALSE(check.margins());
}

}  // namespace
}  // namespace hotblade::robot
