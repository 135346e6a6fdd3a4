#include "elastica/quadratic/quadratic.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/elastica/quadratic/quadratic_quadrature.hpp"

namespace hotblade::elastica {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

TEST(QuadraticLength, AndEnergyAgreeWithQuadratureOnEveryKindOfTriangle) {
  TriangleSource source(1);
  double worst_length = 0, worst_energy = 0;
  for (int i = 0; i < 1500; ++i) {
    const Quadratic q = source.next();
    const QuadraticIntegrals exact = integrate(q);
    worst_length = std::max(worst_length, std::abs(length(q) / exact.length - 1));
    worst_energy = std::max(worst_energy, std::abs(energy(q) / exact.energy - 1));
  }
  EXPECT_LT(worst_length, 1e-14);
  EXPECT_LT(worst_energy, 1e-13);
}

TEST(QuadraticLength, OfCollinearControlPointsIsThatOfTheSegmentsToTheTurningPoint) {
  EXPECT_DOUBLE_EQ(length({Vector2d(0, 0), Vector2d(1, 1), Vector2d(2, 2)}), std::sqrt(8.0));
  EXPECT_DOUBLE_EQ(length({Vector2d(0, 0), Vector2d(0.2, 0), Vector2d(2, 0)}), 2);
  // x = 2 t (1 - t) * 3 + t^2: turns at t = 0.6, x = 1.8.
  EXPECT_DOUBLE_EQ(length({Vector2d(0, 0), Vector2d(3, 0), Vector2d(1, 0)}), 1.8 + 0.8);
  EXPECT_DOUBLE_EQ(length({Vector2d(1, 2), Vector2d(5, 5), Vector2d(1, 2)}), 5);
  EXPECT_EQ(length({Vector2d(1, 2), Vector2d(1, 2), Vector2d(1, 2)}), 0);
}

TEST(QuadraticEnergy, IsZeroForStraightCurvesAndInfiniteForFoldedOnes) {
  EXPECT_EQ(energy({Vector2d(0, 0), Vector2d(1, 1), Vector2d(2, 2)}), 0);
  EXPECT_EQ(energy({Vector2d(0, 0), Vector2d(0.2, 0), Vector2d(2, 0)}), 0);
  EXPECT_EQ(energy({Vector2d(0, 0), Vector2d(0, 0), Vector2d(2, 1)}), 0);
  EXPECT_EQ(energy({Vector2d(1, 2), Vector2d(1, 2), Vector2d(1, 2)}), 0);
  EXPECT_TRUE(std::isinf(energy({Vector2d(0, 0), Vector2d(3, 0), Vector2d(1, 0)})));
}

TEST(QuadraticEnergy, ScalesWithTheInverseOfTheSizeAndDoesNotKnowTheDirectionOfTravel) {
  TriangleSource source(2);
  for (int i = 0; i < 200; ++i) {
    const Quadratic q = source.next();
    const double s = 4;  // exact in binary
    EXPECT_DOUBLE_EQ(energy({s * q[0], s * q[1], s * q[2]}), energy(q) / s);
    EXPECT_DOUBLE_EQ(length({s * q[0], s * q[1], s * q[2]}), length(q) * s);
    EXPECT_NEAR(energy({q[2], q[1], q[0]}) / energy(q), 1, 1e-13);
  }
}

TEST(QuadraticParameter, AtTheLengthToAParameterHasThatLength) {
  TriangleSource source(3);
  for (int i = 0; i < 500; ++i) {
    const Quadratic q = source.next();
    const double whole = length(q);
    for (const double part : {0.0, 1e-9, 0.1, 0.5, 0.77, 1.0}) {
      EXPECT_NEAR(length_to(q, parameter_at(q, part * whole)), part * whole, 1e-14 * whole);
    }
    const double a = 0.3;
    const Quadratic head{q[0], q[0] + a * (q[1] - q[0]), point_at(q, a)};
    EXPECT_NEAR(length_to(q, a), length(head), 1e-10 * whole);  // the corner points of the part are rounded
  }
}

TEST(QuadraticParabola, MapsTheUnitParabolaOntoTheCurve) {
  TriangleSource source(4);
  for (int i = 0; i < 500; ++i) {
    const Quadratic q = source.next();
    const Parabola p = parabola(q);
    ASSERT_EQ(p.status, ParabolaStatus::kOk);
    const Vector2d right{p.axis.y(), -p.axis.x()};
    EXPECT_NEAR(p.axis.norm(), 1, 1e-15);
    const double reach = p.scale * std::max({1.0, std::abs(p.x0), p.x0 * p.x0, p.x1 * p.x1});
    for (const double t : {0.0, 0.2, 0.5, 1.0}) {
      const double x = p.x0 + t * (p.x1 - p.x0);
      const Vector2d mapped = p.origin + p.scale * (x * right + x * x * p.axis);
      EXPECT_LT((mapped - point_at(q, t)).norm(), 1e-12 * (reach + q[1].norm() + p.origin.norm()));
    }
  }
  EXPECT_EQ(parabola({Vector2d(0, 0), Vector2d(1, 1), Vector2d(2, 2)}).status, ParabolaStatus::kLine);
  const Parabola fold = parabola({Vector2d(0, 0), Vector2d(3, 0), Vector2d(1, 0)});
  EXPECT_EQ(fold.status, ParabolaStatus::kFolded);
  EXPECT_NEAR(fold.origin.x(), 1.8, 1e-15);
}

double brute_distance(const Quadratic& q, const Vector2d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 4000; ++i) best = std::min(best, (point_at(q, i / 4000.0) - p).norm());
  return best;
}

TEST(QuadraticNearest, IsNeverFartherThanBruteForceAndLiesOnTheCurve) {
  TriangleSource source(5);
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 600; ++i) {
    const Quadratic q = source.next();
    const double size = (q[1] - q[0]).norm() + (q[2] - q[0]).norm();
    const double far = std::pow(10, normal(random) - 0.5) * size;
    const Vector2d p = point_at(q, normal(random)) + far * Vector2d(normal(random), normal(random));
    const QuadraticNearest n = nearest(q, p);
    EXPECT_LE(n.distance, brute_distance(q, p) * (1 + 1e-14) + 1e-15 * size);
    EXPECT_LT((point_at(q, n.t) - n.point).norm(), 1e-13 * (size + far));
    EXPECT_NEAR((n.point - p).norm(), n.distance, 1e-13 * (size + far));
    EXPECT_TRUE(n.t >= 0 && n.t <= 1);
  }
}

TEST(QuadraticNearest, IsRightOnEveryDegenerateCurve) {
  const Quadratic curves[] = {
      {Vector2d(1, 1), Vector2d(1, 1), Vector2d(1, 1)},    // a point
      {Vector2d(0, 0), Vector2d(1, 1), Vector2d(2, 2)},    // a uniform segment
      {Vector2d(0, 0), Vector2d(0.1, 0), Vector2d(2, 0)},  // a segment
      {Vector2d(0, 0), Vector2d(0, 0), Vector2d(2, 1)},    // an end edge of length zero
      {Vector2d(0, 0), Vector2d(3, 0), Vector2d(1, 0)},    // a fold
      {Vector2d(0, 0), Vector2d(3, 1), Vector2d(0, 0)},    // there and back
      {Vector2d(0, 0), Vector2d(3, 1e-14), Vector2d(1, 0)},
      {Vector2d(0, 0), Vector2d(0.5 + 1e-15, 0.5), Vector2d(1, 1)},
  };
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(-3, 4);
  for (const Quadratic& q : curves) {
    for (int i = 0; i < 60; ++i) {
      const Vector2d p{u(random), u(random)};
      const QuadraticNearest n = nearest(q, p);
      EXPECT_LE(n.distance, brute_distance(q, p) + 1e-15);
      EXPECT_NEAR((point_at(q, n.t) - p).norm(), n.distance, 1e-14);
    }
  }
}

TEST(QuadraticNearest, OnTheEvoluteWhereTwoMinimaMeetIsStillRight) {
  // y = x^2 as a quadratic over [-2, 2]; the centre of curvature of its vertex is (0, 1/2), a triple root.
  const Quadratic q{Vector2d(-2, 4), Vector2d(0, -4), Vector2d(2, 4)};
  EXPECT_NEAR(nearest(q, {0, 0.5}).distance, 0.5, 1e-15);
  // Above it the two minima lie at x^2 = q_y - 1/2, and the distance is sqrt(q_y - 1/4).
  for (const double y : {0.5 + 1e-12, 0.6, 1.0, 3.0}) {
    EXPECT_NEAR(nearest(q, {0, y}).distance, std::sqrt(y - 0.25), 1e-15);
  }
}

TEST(QuadraticLevelSet, OfALengthIsConvexAndHasThatLength) {
  const Vector2d b0{-1, 0}, b2{1, 0};
  for (const double level : {2.0001, 2.05, 2.5, 3.5, 20.0}) {
    const auto set = length_level_set(b0, b2, level, 90);
    ASSERT_EQ(set.size(), 90u);
    for (std::size_t i = 0; i < set.size(); ++i) {
      EXPECT_NEAR(length({b0, set[i], b2}), level, 1e-13 * level);
      const Vector2d a = set[(i + 1) % 90] - set[i], b = set[(i + 2) % 90] - set[(i + 1) % 90];
      EXPECT_GT(cross(a, b), 0) << level << " " << i;
    }
  }
  EXPECT_TRUE(length_level_set(b0, b2, 1.9, 90).empty());
}

TEST(QuadraticLevelSet, OfAnEnergyHasThatEnergyAndIsNotConvex) {
  const Vector2d b0{-1, 0}, b2{1, 0};
  for (const double level : {0.1, 1.0, 3.0, 50.0}) {
    const auto set = energy_level_set(b0, b2, level, 72);
    ASSERT_EQ(set.size(), 72u);
    bool bends_inwards = false;
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (i % 36 != 0) {
        EXPECT_NEAR(energy({b0, set[i], b2}), level, 1e-9 * level);
      }
      const Vector2d a = set[(i + 1) % 72] - set[i], b = set[(i + 2) % 72] - set[(i + 1) % 72];
      bends_inwards |= cross(a, b) < 0;
    }
    EXPECT_TRUE(bends_inwards) << level;
  }
  EXPECT_TRUE(energy_level_set(b0, b2, 0, 72).empty());
}

TEST(QuadraticLevelSet, OfAnEnergyIsCrossedOnceByEveryRayFromTheMidpoint) {
  // What energy_level_set relies on: the energy rises along rays.
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 300; ++i) {
    const double a = std::pow(u(random), 3) * 1.57;
    double last = 0;
    for (double r = 1e-3; r < 1e3; r *= 1.1) {
      const double e = energy({Vector2d(-1, 0), r * Vector2d(std::cos(a), std::sin(a)), Vector2d(1, 0)});
      ASSERT_GT(e, last) << a << " " << r;
      last = e;
    }
  }
}

TEST(QuadraticLevelSet, OfNonsenseIsRefused) {
  const Vector2d a{0, 0}, b{1, 0};
  EXPECT_THROW((void)length_level_set(a, a, 1, 10), std::logic_error);
  EXPECT_THROW((void)length_level_set(a, b, NAN, 10), std::logic_error);
  EXPECT_THROW((void)energy_level_set(a, b, 1, 2), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
