#include "elastica/blade/stability.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <boost/math/special_functions/ellint_1.hpp>
#include <cmath>
#include <numbers>
#include <random>

namespace hotblade::elastica {
namespace {

// The same eigenvalue by a dense solver on the space of the constraints: other code, other grid.
double dense_margin(const Elastica& e, int cells) {
  const int n = cells - 1;
  const double h = 1.0 / cells;
  const ElasticaCurve curve(e);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n), c(n, 2);
  for (int i = 0; i < n; ++i) {
    const double theta = curve.at(e.length * (i + 1) * h).theta;
    a(i, i) = 2 / (h * h) - e.length * e.length * (e.lambda1 * std::cos(theta) + e.lambda2 * std::sin(theta));
    if (i > 0) a(i, i - 1) = a(i - 1, i) = -1 / (h * h);
    c.row(i) << std::cos(theta), std::sin(theta);
  }
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(c).householderQ();
  const Eigen::MatrixXd z = q.rightCols(n - 2);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(z.transpose() * a * z).eigenvalues()[0];
}

TEST(StabilityMargin, AgreesWithADenseSolver) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int trial = 0; trial < 30; ++trial) {
    const Elastica e{0, 0, u(random), 3 * u(random), 40 * u(random), 40 * u(random), 1};
    const double margin = stability_margin(e);
    EXPECT_NEAR(margin, dense_margin(e, 160), 0.01 * (std::abs(margin) + 20));
  }
}

TEST(StabilityMargin, OfAStraightUnloadedBladeIsFourPiSquared) {
  // One constraint, mean of the variation zero: the lowest admissible mode is sin(2 pi s).
  EXPECT_NEAR(stability_margin({0, 0, 0.3, 0, 0, 0, 500}), 4 * std::numbers::pi * std::numbers::pi, 0.05);
}

TEST(StabilityMargin, OfACompressedStraightBladeVanishesAtEulersClampedLoad) {
  // lambda1 > 0 along the blade compresses it; the clamped column buckles at 4 pi^2 / l^2.
  EXPECT_GT(stability_margin({0, 0, 0, 0, 4 * std::numbers::pi * std::numbers::pi * 0.99, 0, 1}), 0);
  EXPECT_LT(stability_margin({0, 0, 0, 0, 4 * std::numbers::pi * std::numbers::pi * 1.01, 0, 1}), 0);
}

TEST(StabilityMargin, ArcsFromAnInflectionLoseStabilityAfterOnePeriod) {
  // kappa itself is then an admissible variation that vanishes at both ends: sliding the curve along itself.
  for (const double k : {0.1, 0.4, 0.7, 0.9}) {
    const double period = 4 * boost::math::ellint_1(k);
    EXPECT_GT(stability_margin({0, 0, 2 * std::asin(k), 0, 1, 0, 0.995 * period}), 0) << k;
    EXPECT_LT(stability_margin({0, 0, 2 * std::asin(k), 0, 1, 0, 1.005 * period}), 0) << k;
  }
}

TEST(StabilityMargin, ArcsFromAVertexStayStableForMoreThanOnePeriod) {
  for (const double k : {0.1, 0.4, 0.7, 0.9}) {
    const double period = 4 * boost::math::ellint_1(k);
    EXPECT_GT(stability_margin({0, 0, 0, 2 * k, 1, 0, 1.1 * period}), 0) << k;
    EXPECT_LT(stability_margin({0, 0, 0, 2 * k, 1, 0, 1.25 * period}), 0) << k;
  }
}

TEST(FirstConjugatePoint, OfAnArcFromAnInflectionIsOnePeriodAndFromAVertexALittleMore) {
  for (const double k : {0.05, 0.2, 0.4, 0.7, 0.9}) {
    const double period = 4 * boost::math::ellint_1(k);
    const auto inflection = first_conjugate_point({0, 0, 2 * std::asin(k), 0, 1, 0, 1}, 2 * period);
    const auto vertex = first_conjugate_point({0, 0, 0, 2 * k, 1, 0, 1}, 2 * period);
    ASSERT_TRUE(inflection && vertex);
    EXPECT_NEAR(*inflection / period, 1, 1e-7) << k;
    EXPECT_GT(*vertex / period, 1.1) << k;
    EXPECT_LT(*vertex / period, 1.23) << k;
  }
}

TEST(FirstConjugatePoint, IsWhereTheMarginVanishesFromAnyStart) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  int found = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Elastica e{0, 0, 3 * u(random), 4 * u(random), 40 * u(random), 40 * u(random), 1};
    const auto conjugate = first_conjugate_point(e, 3);
    e.length = conjugate.value_or(3) * 0.98;
    EXPECT_GT(stability_margin(e), 0) << trial;
    if (!conjugate) continue;
    ++found;
    e.length = *conjugate * 1.02;
    EXPECT_LT(stability_margin(e), 0) << trial;
  }
  EXPECT_GT(found, 20);
}

TEST(FirstConjugatePoint, IsAbsentWithoutInflections) {
  EXPECT_FALSE(first_conjugate_point({0, 0, 0, 2.1, 1, 0, 1}, 12));
  EXPECT_FALSE(first_conjugate_point({0, 0, 0, 0, 0, 0, 1}, 100));
  EXPECT_FALSE(first_conjugate_point({0, 0, 0, 2.1, 1, 0, 1}, 0));
}

TEST(StabilityMargin, ArcsWithoutInflectionAreStable) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(0, 1);
  for (int trial = 0; trial < 100; ++trial) {
    const double k0 =
        2.05 + 3 * u(random);  // above the separatrix of lambda = 1: curvature never changes sign
    EXPECT_GT(stability_margin({0, 0, 0, k0, 1, 0, 8 * u(random) + 0.1}), 0);
  }
}

TEST(StabilityMargin, FromANeighboursMarginIsTheSame) {
  Elastica e{0, 0, 0.3, -0.002, 1e-6, 2e-6, 800};
  double last = stability_margin(e);
  for (int i = 0; i < 40; ++i) {
    // Close to the last one, and far from it.
    e.kappa += i % 2 == 0 ? 1e-7 : 3e-4;
    const double exact = stability_margin(e);
    EXPECT_NEAR(stability_margin(e, last), exact, 4e-6 * (1 + std::abs(exact))) << i;
    last = exact;
  }
}

}  // namespace
}  // namespace hotblade::elastica
