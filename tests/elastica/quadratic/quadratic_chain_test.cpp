// The chain's bound against distances measured on dense samples, both ways.
#include "elastica/quadratic/quadratic_chain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace hotblade::elastica {
namespace {

using Eigen::Vector2d;

Elastica random_elastica(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> u(-1, 1);
  Elastica e;
  e.x = u(rng);
  e.y = u(rng);
  e.theta = 3 * u(rng);
  e.kappa = 4 * u(rng);
  e.lambda1 = 12 * u(rng);
  e.lambda2 = 12 * u(rng);
  e.length = 1 + u(rng) * 0.5;
  return e;
}

// Largest distance from samples of either curve to the other.
double measured_deviation(const Elastica& e, const QuadraticChain& chain) {
  const ElasticaCurve curve(e);
  double most = 0;
  constexpr int kSamples = 400;
  for (int i = 0; i <= kSamples; ++i) {
    const Vector2d p = curve.at(e.length * i / kSamples).position();
    double nearest_to = std::numeric_limits<double>::infinity();
    for (const Quadratic& q : chain.pieces) nearest_to = std::min(nearest_to, nearest(q, p).distance);
    most = std::max(most, nearest_to);
  }
  for (std::size_t k = 0; k < chain.pieces.size(); ++k) {
    for (const double u : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const Vector2d p = point_at(chain.pieces[k], u);
      // Newton's method for the foot, from the share of the piece.
      double s = chain.arc_length[k] + u * (chain.arc_length[k + 1] - chain.arc_length[k]);
      for (int n = 0; n < 8; ++n) {
        const CurvePoint at = curve.at(s);
        const Vector2d r = at.position() - p, t = at.tangent(), normal(-t.y(), t.x());
        s = std::clamp(s - r.dot(t) / (1 + at.kappa * r.dot(normal)), 0.0, e.length);
      }
      most = std::max(most, (curve.at(s).position() - p).norm());
    }
  }
  return most;
}

TEST(QuadraticChain, StaysWithinItsBoundAndTheBoundWithinTheTolerance) {
  std::mt19937_64 rng(1);
  for (int n = 0; n < 40; ++n) {
    const Elastica e = random_elastica(rng);
    for (const double tolerance : {1e-1, 1e-3, 1e-5, 1e-7}) {
      const QuadraticChain chain = quadratic_chain(e, tolerance);
      EXPECT_LE(chain.bound, tolerance);
      EXPECT_LE(measured_deviation(e, chain), chain.bound + 1e-12);
    }
  }
}

TEST(QuadraticChain, HasABoundThatIsNotManyTimesTheDeviation) {
  std::mt19937_64 rng(2);
  for (int n = 0; n < 20; ++n) {
    const Elastica e = random_elastica(rng);
    const QuadraticChain chain = quadratic_chain(e, 1e-4);
    EXPECT_LE(chain.bound, 4 * measured_deviation(e, chain));
  }
}

TEST(QuadraticChain, NeedsPiecesWithTheFourthRootOfTheTolerance) {
  std::mt19937_64 rng(3);
  for (int n = 0; n < 20; ++n) {
    const Elastica e = random_elastica(rng);
    const auto coarse = static_cast<double>(quadratic_chain(e, 1e-4).pieces.size()),
               fine = static_cast<double>(quadratic_chain(e, 1e-8).pieces.size());
    EXPECT_LE(fine, 14 * coarse);
  }
}

TEST(QuadraticChain, RunsEndToEndWithCommonTangents) {
  std::mt19937_64 rng(4);
  for (int n = 0; n < 20; ++n) {
    const Elastica e = random_elastica(rng);
    const QuadraticChain chain = quadratic_chain(e, 1e-5);
    ASSERT_EQ(chain.arc_length.size(), chain.pieces.size() + 1);
    EXPECT_EQ(chain.arc_length.front(), 0);
    EXPECT_EQ(chain.arc_length.back(), e.length);
    EXPECT_TRUE(std::is_sorted(chain.arc_length.begin(), chain.arc_length.end()));
    for (std::size_t i = 1; i < chain.pieces.size(); ++i) {
      const Quadratic &a = chain.pieces[i - 1], &b = chain.pieces[i];
      EXPECT_EQ(a[2], b[0]);
      const Vector2d in = (a[2] - a[1]).normalized(), out = (b[1] - b[0]).normalized();
      EXPECT_NEAR((in - out).norm(), 0, 1e-6);
    }
  }
}

TEST(QuadraticChain, TakesLinesCirclesPointsAndInflections) {
  const QuadraticChain line = quadratic_chain({1, 2, 0.5, 0, 0, 0, 10}, 1e-9);
  EXPECT_EQ(line.pieces.size(), 1u);
  EXPECT_LE(line.bound, 1e-11);
  const Elastica circle{0, 0, 0, 0.5, 0, 0, 4 * std::numbers::pi};
  const QuadraticChain around = quadratic_chain(circle, 1e-4);
  EXPECT_LE(measured_deviation(circle, around), around.bound + 1e-12);
  EXPECT_EQ(quadratic_chain({1, 2, 0.5, 1, 2, 3, 0}, 1).pieces.size(), 1u);
  const Elastica wave{0, 0, 0, 0, 0, 20, 1};  // an inflection at its start
  const QuadraticChain bent = quadratic_chain(wave, 1e-6);
  EXPECT_LE(measured_deviation(wave, bent), bent.bound + 1e-12);
  EXPECT_LE(bent.bound, 1e-6);
}

TEST(QuadraticChain, RefusesTolerancesAndCurvesThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Elastica e{0, 0, 0, 1, 0, 0, 1};
  EXPECT_THROW((void)quadratic_chain(e, 0), std::logic_error);
  EXPECT_THROW((void)quadratic_chain(e, nan), std::logic_error);
  EXPECT_THROW((void)quadratic_chain({nan, 0, 0, 1, 0, 0, 1}, 1), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
