#include "elastica/blade/equilibria.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>

#include "tests/elastica/blade/discrete_rod.hpp"

namespace hotblade::elastica {
namespace {

using testing::DiscreteRod;

constexpr double kMostEnergy = 100;

// Clamps of a blade of length 1: any, nearly straight, symmetric, and with ends turned by more than half a
// turn.
ClampPair random_clamps(std::mt19937_64& random, int kind) {
  std::uniform_real_distribution<double> u(-1, 1);
  const double lean = 1.2 * u(random), far = 0.5 + 0.45 * std::abs(u(random));
  switch (kind % 4) {
    case 0:
      return {{0, 0, 0}, {0.9 * u(random), 0.4 * u(random), 4 * u(random)}};
    case 1:
      return {{0, 0, 0}, {0.99 + 0.008 * u(random), 0.02 * u(random), 0.1 * u(random)}};
    case 2:
      return {{0, 0, lean}, {far, 0, -lean}};
    default:
      return {{0, 0, 0},
              {0.4 * u(random), 0.4 * u(random),
               (u(random) < 0 ? -1 : 1) * (std::numbers::pi + 3 * std::abs(u(random)))}};
  }
}

double difference(const Elastica& a, const Elastica& b) {
  return std::abs(a.kappa - b.kappa) + std::abs(a.lambda1 - b.lambda1) + std::abs(a.lambda2 - b.lambda2);
}

bool contains(const EquilibriaReport& report, const Elastica& e) {
  for (const Equilibrium& q : report.equilibria) {
    if (difference(q.elastica, e) < 1e-3 * (1 + std::abs(e.lambda1) + std::abs(e.lambda2))) return true;
  }
  return false;
}

double bending_energy(const Elastica& e) {
  const ElasticaCurve curve(e);
  constexpr int kCells = 400;
  double sum = 0;  // Simpson's rule
  for (int i = 0; i <= kCells; ++i) {
    const double kappa = curve.at(e.length * i / kCells).kappa;
    sum += (i == 0 || i == kCells ? 1 : i % 2 == 1 ? 4 : 2) * kappa * kappa;
  }
  return 0.5 * sum * e.length / (3 * kCells);
}

// Pairs of clamps in the tests below. The whole check of 1,000 pairs: HOTBLADE_CLAMP_PAIRS=1000.
int pairs(int usual) {
  const char* const asked = std::getenv("HOTBLADE_CLAMP_PAIRS");
  return asked != nullptr ? std::atoi(asked) : usual;
}

TEST(FindEquilibria, FindsEveryShapeThatNewtonsMethodFindsFromTwoThousandStarts) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  int found_by_newton = 0, found = 0, unresolved = 0;
  double seconds = 0;
  for (int pair = 0; pair < pairs(8); ++pair) {
    const ClampPair clamps = random_clamps(random, pair);
    const auto start = std::chrono::steady_clock::now();
    const EquilibriaReport all = find_equilibria(clamps, 1, {6, kMostEnergy});
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    found += int(all.equilibria.size());
    unresolved += all.unresolved;
    for (int i = 0; i < 2000; ++i) {
      const double force = 400 * u(random) * u(random), angle = std::numbers::pi * u(random);
      const auto shape = solve_clamped({clamps.a.x, clamps.a.y, clamps.a.theta, 20 * u(random),
                                        force * std::cos(angle), force * std::sin(angle), 1},
                                       clamps);
      if (!shape || count_inflections(shape->elastica) > 6) continue;
      if (bending_energy(shape->elastica) > kMostEnergy * 0.9999) continue;
      ++found_by_newton;
      EXPECT_TRUE(contains(all, shape->elastica)) << pair << " kappa " << shape->elastica.kappa;
    }
  }
  EXPECT_GT(found_by_newton, 100);
  EXPECT_EQ(unresolved, 0);
  RecordProperty("equilibria", found);
  RecordProperty("milliseconds_per_pair", std::to_string(1e3 * seconds / pairs(8)));
}

TEST(FindEquilibria, EnergyStabilityAndInflectionsAgreeWithADiscreteRod) {
  std::mt19937_64 random(2);
  constexpr int kSegments = 400;
  int compared = 0, stable = 0;
  for (int pair = 0; pair < pairs(20); ++pair) {
    const ClampPair clamps = random_clamps(random, pair);
    for (const Equilibrium& q : find_equilibria(clamps, 1, {4, kMostEnergy}).equilibria) {
      std::vector<double> angles;
      const ElasticaCurve curve(q.elastica);
      for (int i = 0; i < kSegments; ++i)
        angles.push_back(curve.at((i + 0.5) / kSegments).theta - clamps.a.theta);
      const double c = std::cos(clamps.a.theta), s = std::sin(clamps.a.theta);
      const double dx = clamps.b.x - clamps.a.x, dy = clamps.b.y - clamps.a.y;
      DiscreteRod rod(c * dx + s * dy, c * dy - s * dx, clamps.b.theta - clamps.a.theta, angles);
      // About to be lost: the rod of segments may have lost it.
      if (std::abs(q.margin) < 1) continue;
      ASSERT_TRUE(rod.to_critical_point());
      double moved = 0;
      for (std::size_t i = 0; i < angles.size(); ++i)
        moved = std::max(moved, std::abs(angles[i] - rod.angles()[i]));
      EXPECT_LT(moved, 0.02);
      EXPECT_NEAR(rod.energy(), q.energy, 2e-3 * (1 + q.energy));
      EXPECT_EQ(rod.negative_eigenvalues() == 0, q.stable);
      EXPECT_EQ(q.stable, q.margin > 0);
      // An inflection within a segment of a clamp may be counted or not.
      const double end_angle = curve.at(1).kappa;
      if (std::min(std::abs(q.elastica.kappa), std::abs(end_angle)) > 0.2) {
        EXPECT_EQ(rod.inflections(), q.inflections);
      }
      EXPECT_NEAR(bending_energy(q.elastica), q.energy, 1e-6 * (1 + q.energy));
      ++compared;
      stable += q.stable ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 30);
  EXPECT_GT(stable, 8);
  EXPECT_LT(stable, compared);
}

TEST(FindEquilibria, EveryMinimumThatADiscreteRodDescendsToIsAmongTheStableShapes) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  constexpr std::size_t kSegments = 100;
  int minima = 0;
  for (int pair = 0; pair < pairs(10); ++pair) {
    const ClampPair clamps = random_clamps(random, 2 * pair);
    const EquilibriaReport all = find_equilibria(clamps, 1, {2, kMostEnergy});
    if (all.taut > 0) continue;  // left out, and said so
    const double c = std::cos(clamps.a.theta), s = std::sin(clamps.a.theta);
    const double dx = clamps.b.x - clamps.a.x, dy = clamps.b.y - clamps.a.y,
                 turning = clamps.b.theta - clamps.a.theta;
    for (int start = 0; start < 10; ++start) {
      const double a1 = 2 * u(random), a2 = 2 * u(random), a3 = u(random);
      std::vector<double> angles(kSegments);
      for (std::size_t i = 0; i < kSegments; ++i) {
        const double t = (double(i) + 0.5) / double(kSegments);
        angles[i] = turning * t + a1 * std::sin(std::numbers::pi * t) +
                    a2 * std::sin(2 * std::numbers::pi * t) + a3 * std::sin(3 * std::numbers::pi * t);
      }
      DiscreteRod rod(c * dx + s * dy, c * dy - s * dx, turning, angles);
      if (!rod.to_minimum() || rod.energy() > 0.9 * kMostEnergy) continue;
      ++minima;
      const bool found = std::any_of(all.equilibria.begin(), all.equilibria.end(), [&](const Equilibrium& q) {
        return q.stable && std::abs(q.energy - rod.energy()) < 0.01 * (1 + q.energy);
      });
      EXPECT_TRUE(found) << pair << " energy " << rod.energy();
    }
  }
  EXPECT_GT(minima, 15);
}

TEST(FindEquilibria, ShapesWithoutInflectionAreStableAndThoseWithThreeOrMoreAreNot) {
  std::mt19937_64 random(4);
  int plain = 0, wavy = 0;
  for (int pair = 0; pair < 80; ++pair) {
    for (const Equilibrium& q :
         find_equilibria(random_clamps(random, pair), 1, {4, kMostEnergy}).equilibria) {
      EXPECT_TRUE(q.stable || q.inflections > 0);
      EXPECT_TRUE(!q.stable || q.inflections < 3);
      plain += q.inflections == 0 ? 1 : 0;
      wavy += q.inflections >= 3 ? 1 : 0;
    }
  }
  EXPECT_GT(plain, 3);
  EXPECT_GT(wavy, 20);
}

TEST(FindEquilibria, OfTheSymmetricArchAreTwoStableAndMoreThanTenAreNot) {
  const EquilibriaReport r = find_equilibria({{0, 0, 0.6}, {0.8, 0, -0.6}}, 1, {8, 200});
  int stable = 0;
  for (const Equilibrium& q : r.equilibria) stable += q.stable ? 1 : 0;
  EXPECT_EQ(stable, 2);
  EXPECT_TRUE(r.equilibria[0].stable && r.equilibria[1].stable);
  EXPECT_NEAR(r.equilibria[0].energy, 2.955, 0.001);
  EXPECT_NEAR(r.equilibria[1].energy, 15.784, 0.001);
  EXPECT_GT(r.equilibria.size(), 12u);
  EXPECT_EQ(r.unresolved, 0);
}

TEST(FindEquilibria, NoneWhereTheClampsAreFurtherApartThanTheBladeIsLong) {
  EXPECT_TRUE(find_equilibria({{0, 0, 0}, {1.001, 0, 0}}, 1).equilibria.empty());
  EXPECT_TRUE(find_equilibria({{0, 0, 0.1}, {1, 0, 0.1}}, 1).equilibria.empty());
  const EquilibriaReport straight =
      find_equilibria({{3, 4, 0.5}, {3 + 500 * std::cos(0.5), 4 + 500 * std::sin(0.5), 0.5}}, 500);
  ASSERT_EQ(straight.equilibria.size(), 1u);
  EXPECT_NEAR(straight.equilibria[0].energy, 0, 1e-12);
  EXPECT_TRUE(straight.equilibria[0].stable);
}

TEST(FindEquilibria, TellsOfATautShapeThatAStartStateCannotCarry) {
  // A chain of 400 segments has a minimum here, of energy 35.7: straight but for sharp bends at both clamps.
  const EquilibriaReport r = find_equilibria({{0, 0, 0}, {0.898479, -0.359776, -2.49912}}, 1);
  EXPECT_TRUE(r.equilibria.empty());
  EXPECT_EQ(r.taut, 1);
}

TEST(FindEquilibria, ClosedLoopsIncludeTheCircle) {
  const EquilibriaReport r = find_equilibria({{0, 0, 0}, {0, 0, 2 * std::numbers::pi}}, 1);
  ASSERT_FALSE(r.equilibria.empty());
  EXPECT_NEAR(r.equilibria[0].energy, 2 * std::numbers::pi * std::numbers::pi, 1e-6);
  EXPECT_EQ(r.equilibria[0].inflections, 0);
}

TEST(FindEquilibria, TurningIsNotTakenModuloAFullTurn) {
  const auto once = find_equilibria({{0, 0, 0}, {0.5, 0.1, 0.3}}, 1),
             twice = find_equilibria({{0, 0, 0}, {0.5, 0.1, 0.3 + 2 * std::numbers::pi}}, 1);
  ASSERT_FALSE(once.equilibria.empty());
  ASSERT_FALSE(twice.equilibria.empty());
  EXPECT_GT(std::abs(once.equilibria[0].energy - twice.equilibria[0].energy), 1);
  for (const Equilibrium& q : twice.equilibria) {
    EXPECT_NEAR(clamps_of(q.elastica).b.theta, 0.3 + 2 * std::numbers::pi, 1e-8);
  }
}

TEST(FindEquilibria, MovedMirroredReversedAndScaledClampsHaveTheSameShapes) {
  std::mt19937_64 random(5);
  for (int pair = 0; pair < 4; ++pair) {
    const ClampPair c = random_clamps(random, pair);
    const auto plain = find_equilibria(c, 1);
    const ClampPair mirrored{{c.a.x, -c.a.y, -c.a.theta}, {c.b.x, -c.b.y, -c.b.theta}};
    const ClampPair reversed{{c.b.x, c.b.y, c.b.theta + std::numbers::pi},
                             {c.a.x, c.a.y, c.a.theta + std::numbers::pi}};
    const auto moved = [](const PlanarPose& p) {
      return PlanarPose{700 * -p.y + 20, 700 * p.x - 5, p.theta + std::numbers::pi / 2};
    };
    const std::pair<EquilibriaReport, double> others[] = {
        {find_equilibria(mirrored, 1), 1},
        {find_equilibria(reversed, 1), 1},
        {find_equilibria({moved(c.a), moved(c.b)}, 700), 700}};
    for (const auto& [other, scale] : others) {
      ASSERT_EQ(other.equilibria.size(), plain.equilibria.size()) << pair;
      for (std::size_t i = 0; i < plain.equilibria.size(); ++i) {
        EXPECT_NEAR(other.equilibria[i].energy * scale, plain.equilibria[i].energy,
                    1e-6 * (1 + plain.equilibria[i].energy));
        EXPECT_EQ(other.equilibria[i].inflections, plain.equilibria[i].inflections);
      }
    }
  }
}

TEST(FindEquilibria, RefusesNonsense) {
  EXPECT_THROW((void)find_equilibria({{0, 0, NAN}, {1, 0, 0}}, 1), std::logic_error);
  EXPECT_THROW((void)find_equilibria({{0, 0, 0}, {1, 0, 0}}, 0), std::logic_error);
  EXPECT_THROW((void)find_equilibria({{0, 0, 0}, {1, 0, 0}}, 1, {kMaxInflections + 1, 10}), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
