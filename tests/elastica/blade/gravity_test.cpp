#include "elastica/blade/gravity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "elastica/blade/stability.hpp"
#include "tests/elastica/blade/heavy_rod.hpp"

namespace hotblade::elastica {
namespace {

using hotblade::testing::HeavyRod;
using hotblade::testing::RodStiffness;

// A strip 16 times as wide as thick, of steel.
constexpr StiffnessRatios kFlatStrip{256, 1.54};

// Stable shapes: a shallow and a deep arc, an arch under load, an S, and one with both forces.
std::vector<Elastica> shapes() {
  std::vector<Elastica> all{{0, 0, 0.2, 0.4, 0, 0, 1},
                            {5, -3, 1.0, 2.4, 0, 0, 1},
                            {0, 0, -0.9, 2.0, 6, 0, 1},
                            {0, 0, 0.5, -1.0, 8, 6, 1},
                            {1, 2, 0.3, 1.5, -9, 4, 1}};
  return all;
}

TEST(PlaneShift, MatchesADiscreteHeavyRodAtSmallLoads) {
  for (const Elastica& e : shapes()) {
    ASSERT_GT(stability_margin(e), 5);
    for (const double direction : {0.3, 1.9}) {
      const Eigen::Vector2d load = 0.02 * Eigen::Vector2d(std::cos(direction), std::sin(direction));
      constexpr int n = 80;
      // The rod's own shape differs from the elastica by its discretisation; that cancels in the difference.
      HeavyRod rod(e, n, {1.54, 256, 1});
      const auto free = rod.relax(Eigen::Vector3d::Zero());
      const auto loaded = rod.relax({load.x(), load.y(), 0});
      const PlaneShift shift = plane_shift(e, load);
      for (std::size_t i = 0; i <= n; i += 5) {
        const Eigen::Vector2d expected = (loaded[i] - free[i]).head<2>();
        EXPECT_LT((shift.shift[i * kGravityCells / n] - expected).norm(), 0.02 * shift.largest)
            << e.kappa << " " << i;
      }
    }
  }
}

TEST(PlaneShift, ErrorFallsWithTheLoadAsFirstOrderShould) {
  const Elastica e = shapes()[3];
  double error[2];
  for (const int k : {0, 1}) {
    const Eigen::Vector2d load(0, k == 0 ? 2.0 : 1.0);
    HeavyRod rod(e, 64, {1.54, 256, 1});
    const auto free = rod.relax(Eigen::Vector3d::Zero());
    const auto loaded = rod.relax({0, load.y(), 0});
    const auto back = rod.relax({0, -load.y(), 0});
    const std::size_t middle = 32;
    // Half the difference of both signs is the odd part; the rest is the second order that is left out.
    const Eigen::Vector3d even = 0.5 * (loaded[middle] + back[middle]) - free[middle];
    error[k] = even.norm();
  }
  EXPECT_NEAR(error[0] / error[1], 4, 0.4);
}

TEST(PlaneShift, OfAStraightBladeIsTheClampedBeams) {
  const PlaneShift shift =
      plane_shift({3, 4, 0.7, 0, 0, 0, 2}, Eigen::Rotation2Dd(0.7) * Eigen::Vector2d(0.5, -0.1));
  EXPECT_NEAR(shift.largest, 0.1 * std::pow(2.0, 4) / 384, 1e-4 * shift.largest);
  const Eigen::Vector2d middle = Eigen::Rotation2Dd(-0.7) * shift.shift[kGravityCells / 2];
  EXPECT_NEAR(middle.x(), 0, 1e-12);
  EXPECT_LT(middle.y(), 0);
}

TEST(PlaneShift, TurnsAndScalesWithTheBlade) {
  const Elastica e = shapes()[4];
  const Eigen::Vector2d load(0.3, -0.2);
  const PlaneShift base = plane_shift(e, load);
  const double turn = 1.1, scale = 700;
  const Eigen::Rotation2Dd r(turn);
  const Eigen::Vector2d force = r * Eigen::Vector2d(e.lambda1, e.lambda2) / (scale * scale);
  const Elastica big{0, 0, e.theta + turn, e.kappa / scale, force.x(), force.y(), e.length * scale};
  const PlaneShift turned = plane_shift(big, r * load / std::pow(scale, 3));
  for (std::size_t i = 0; i < base.shift.size(); i += 16) {
    EXPECT_LT((turned.shift[i] / scale - r * base.shift[i]).norm(), 1e-9 * base.largest);
  }
}

TEST(Droop, MatchesADiscreteHeavyRodInSpace) {
  for (const Elastica& e : shapes()) {
    constexpr int n = 60;
    constexpr double load = -0.01;
    HeavyRod rod(e, n, {kFlatStrip.torsion, kFlatStrip.upright, 1});
    const auto loaded = rod.relax({0, 0, load});
    const Droop d = droop(e, load, kFlatStrip);
    ASSERT_TRUE(d.stable);
    for (std::size_t i = 0; i <= n; i += 5) {
      const double at = static_cast<double>(i) * kGravityCells / n;
      const auto cell = std::min(static_cast<std::size_t>(at), d.shift.size() - 2);
      const double share = at - static_cast<double>(cell);
      const double expected = (1 - share) * d.shift[cell] + share * d.shift[cell + 1];
      EXPECT_NEAR(loaded[i].z(), expected, 0.02 * d.largest) << e.kappa << " " << i;
    }
  }
}

TEST(Droop, OfAStraightBladeIsTheClampedBeams) {
  const Droop d = droop({0, 0, 0.4, 0, 0, 0, 800}, 1e-9, kFlatStrip);
  EXPECT_NEAR(d.largest, 1e-9 * std::pow(800.0, 4) / (384 * kFlatStrip.upright), 1e-4 * d.largest);
  EXPECT_GT(d.shift[kGravityCells / 2], 0);
  EXPECT_EQ(d.largest_twist, 0);
}

TEST(Droop, OfACurvedBladeIsRuledByItsTwist) {
  // The same length and weight, bent to 1.2 rad: it sags several times as far as the straight one, because
  // the strip twists more easily than it bends upright.
  const double straight = droop({0, 0, 0, 0, 0, 0, 1}, 1, kFlatStrip).largest;
  EXPECT_GT(droop({0, 0, 0, 1.2, 0, 0, 1}, 1, kFlatStrip).largest, 2 * straight);
}

TEST(Droop, SaysWhenTheBladeTipsOutOfItsPlane) {
  // Stiff upright, phi follows psi: Int C (psi'' + kappa^2 psi)^2 / kappa^2 + psi'^2 - kappa^2 psi^2, which
  // one wave of psi makes negative on a coil of more than a turn when the twist is soft enough.
  const Elastica coil{0, 0, 0, 3 * std::numbers::pi, 0, 0, 1};
  EXPECT_FALSE(droop(coil, 0, {256, 0.02}).stable);
  EXPECT_TRUE(droop(coil, 0, kFlatStrip).stable);
  EXPECT_TRUE(droop({0, 0, 0, 1, 0, 0, 1}, 0, kFlatStrip).stable);
}

TEST(TurnedEnds, OfAStraightBladeAreABeamsAndAShafts) {
  constexpr double kLength = 700, kTurn = 0.01;
  const Elastica straight{0, 0, 0, 0, 0, 0, kLength};
  const Droop bent = turned_ends(straight, {0, kTurn, 0, 0}, kFlatStrip),
              twisted = turned_ends(straight, {0, 0, kTurn, 0}, kFlatStrip);
  ASSERT_TRUE(bent.stable);
  for (std::size_t i = 0; i <= kGravityCells; i += 16) {
    const double u = static_cast<double>(i) / kGravityCells;
    EXPECT_NEAR(bent.shift[i], -kTurn * kLength * u * (1 - u) * (1 - u), 1e-4 * kTurn * kLength) << u;
    EXPECT_NEAR(twisted.twist[i], kTurn * u, 1e-9);
    EXPECT_NEAR(twisted.shift[i], 0, 1e-9);
  }
}

TEST(TurnedEnds, AllOfABladeTurnsAboutItsChordWithBothClamps) {
  constexpr double kTurn = 0.003;
  for (const Elastica& e : shapes()) {
    const ElasticaCurve curve(e);
    const CurvePoint first = curve.at(0), last = curve.at(e.length);
    const Eigen::Vector2d chord = (last.position() - first.position()).normalized();
    const auto turn = [&](const CurvePoint& p) {
      const Eigen::Vector2d t = p.tangent(), left(-t.y(), t.x());
      return std::pair(kTurn * chord.dot(t), kTurn * chord.dot(left));  // phi, psi
    };
    const auto [phi_a, psi_a] = turn(first);
    const auto [phi_b, psi_b] = turn(last);
    const Droop turned = turned_ends(e, {phi_a, psi_a, phi_b, psi_b}, kFlatStrip);
    for (std::size_t i = 0; i <= kGravityCells; i += 32) {
      const CurvePoint p = curve.at(e.length * static_cast<double>(i) / kGravityCells);
      const Eigen::Vector2d from = p.position() - first.position();
      EXPECT_NEAR(turned.shift[i], kTurn * (chord.x() * from.y() - chord.y() * from.x()),
                  1e-3 * kTurn * e.length);
      EXPECT_NEAR(turned.twist[i], turn(p).first, 1e-3 * kTurn);
    }
  }
}

TEST(TurnedEnds, MatchADiscreteRodWhoseClampsTurnApart) {
  constexpr int n = 80;
  constexpr double kTurn = 2e-3;
  for (const Elastica& e : shapes()) {
    for (int which = 0; which < 4; ++which) {
      Eigen::Vector4d by = Eigen::Vector4d::Zero();  // phi and psi of the first end, then of the last
      by[which] = kTurn;
      HeavyRod rod(e, n, {1.54, 256, 1});
      const auto free = rod.relax(Eigen::Vector3d::Zero());
      rod.turn_ends({by[0], by[1], 0}, {by[2], by[3], 0});
      const auto moved = rod.relax(Eigen::Vector3d::Zero());
      const Droop turned = turned_ends(e, {by[0], by[1], by[2], by[3]}, kFlatStrip);
      for (std::size_t i = 0; i <= n; i += 5) {
        EXPECT_NEAR(turned.shift[i * kGravityCells / n], (moved[i] - free[i]).z(), 0.03 * turned.largest)
            << e.kappa << " " << which << " " << i;
      }
    }
  }
}

TEST(LateralMargin, ChangesSignWhereTheDroopStopsBeingStable) {
  for (const double torsion : {0.05, 0.1, 0.2, 0.4, 0.8, 1.6}) {
    for (const double turn : {1.0, 3.0, 5.0, 6.28, 9.0}) {
      const Elastica arc{0, 0, 0, turn, 0, 0, 1};
      EXPECT_EQ(lateral_margin(arc, {256, torsion}) > 0, droop(arc, 0, {256, torsion}).stable) << turn;
    }
  }
}

TEST(LateralMargin, OfAStraightBladeIsThatOfItsSofterMode) {
  // Twist alone: C pi^2. Bending upright with its ends held: A (2 pi)^2.
  EXPECT_NEAR(lateral_margin({0, 0, 0, 0, 0, 0, 300}, {256, 1.54}),
              1.54 * std::numbers::pi * std::numbers::pi, 0.01);
  EXPECT_NEAR(lateral_margin({0, 0, 0, 0, 0, 0, 300}, {0.1, 1.54}),
              0.1 * 4 * std::numbers::pi * std::numbers::pi, 0.01);
}

TEST(Gravity, RefusesNumbersThatAreNotFinite) {
  const double nan = std::nan("");
  EXPECT_THROW((void)plane_shift({0, 0, 0, 0, 0, 0, 1}, {nan, 0}), std::logic_error);
  EXPECT_THROW((void)droop({0, 0, 0, nan, 0, 0, 1}, 1, kFlatStrip), std::logic_error);
  EXPECT_THROW((void)droop({0, 0, 0, 1, 0, 0, 1}, 1, {0, 1}), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
