#include "elastica/curve/elastica.hpp"

#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <numbers>
#include <random>

namespace hotblade::elastica {
namespace {

// xi_k(s) = (2 E(s) - s, 2 k (1 - cn s)) is an elastica for k < 1 (maths, closed form): starts at the origin
// along +x with curvature 0... its tangent angle has sin(theta/2) = k sn, so theta' = 2 k cn.
CurvePoint closed_form(double k, double s) {
  double cn = 0, dn = 0;
  const double sn = boost::math::jacobi_elliptic(k, s, &cn, &dn);
  const double amplitude =
      std::atan2(sn, cn) +
      2 * std::numbers::pi *
          std::round((s / boost::math::ellint_1(k) * std::numbers::pi / 2 - std::atan2(sn, cn)) /
                     (2 * std::numbers::pi));
  return {2 * boost::math::ellint_2(k, amplitude) - s, 2 * k * (1 - cn), 2 * std::asin(k * sn), 2 * k * cn};
}

TEST(ElasticaCurve, AgreesWithTheClosedFormOfInflectionalCurvesOverThreePeriods) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> modulus(0.01, 0.995), share(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    const double k = modulus(random);
    const double length = 12 * boost::math::ellint_1(k);
    // kappa = 2k cn = 2k - y, so lambda1 = 1 about the start (0, 0) with kappa0 = 2k.
    const ElasticaCurve curve({0, 0, 0, 2 * k, 1, 0, length});
    for (int i = 0; i < 10; ++i) {
      const double s = length * share(random);
      const CurvePoint a = curve.at(s), b = closed_form(k, s);
      EXPECT_NEAR(a.x, b.x, 2e-12 * length) << k << " " << s;
      EXPECT_NEAR(a.y, b.y, 2e-12 * length) << k << " " << s;
      EXPECT_NEAR(a.kappa, b.kappa, 1e-10) << k << " " << s;
    }
  }
}

TEST(ElasticaCurve, LinesAndCirclesAreExact) {
  const CurvePoint line = ElasticaCurve({1, 2, 0.3, 0, 0, 0, 1000}).at(700);
  EXPECT_NEAR(line.x, 1 + 700 * std::cos(0.3), 1e-11);
  EXPECT_NEAR(line.y, 2 + 700 * std::sin(0.3), 1e-11);
  const double r = 200;
  const ElasticaCurve circle({0, 0, 0, 1 / r, 0, 0, 1500});
  for (double s = 0; s <= 1500; s += 50) {
    EXPECT_NEAR(circle.at(s).x, r * std::sin(s / r), 1e-11);
    EXPECT_NEAR(circle.at(s).y, r * (1 - std::cos(s / r)), 1e-11);
  }
}

Elastica random_short_elastica(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  return {100 * u(random), 100 * u(random), 3 * u(random),  3 * u(random),
          20 * u(random),  20 * u(random),  1.5 + u(random)};
}

TEST(ElasticaCurve, CurvatureIsAffineInPositionAndIsTheTangentsRate) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const Elastica e = random_short_elastica(random);
    const ElasticaCurve curve(e);
    const double s = e.length * 0.7, h = 1e-5;
    const CurvePoint p = curve.at(s), before = curve.at(s - h), after = curve.at(s + h);
    EXPECT_NEAR(p.kappa, e.kappa - e.lambda1 * (p.y - e.y) + e.lambda2 * (p.x - e.x), 1e-11);
    EXPECT_NEAR((after.theta - before.theta) / (2 * h), p.kappa, 1e-6);
    EXPECT_NEAR((after.position() - before.position()).norm() / (2 * h), 1, 1e-8);
  }
}

TEST(Segment, ExtendsBothWaysAlongTheSameCurve) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const Elastica e = random_short_elastica(random);
    const Elastica longer = segment(e, -0.3, e.length + 0.4);
    const ElasticaCurve a(e), b(longer);
    for (double u : {0.0, 0.3, 1.0}) {
      EXPECT_LT((a.at(u * e.length).position() - b.at(0.3 + u * e.length).position()).norm(), 1e-11);
    }
    const Elastica back = segment(longer, 0.3, 0.3 + e.length);
    EXPECT_NEAR(back.kappa, e.kappa, 1e-10);
    EXPECT_NEAR(back.theta, e.theta, 1e-11);
  }
}

TEST(Reversed, RunsTheSamePointsBackwards) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 300; ++trial) {
    const Elastica e = random_short_elastica(random);
    const ElasticaCurve a(e), b(reversed(e));
    for (double u : {0.0, 0.25, 0.9}) {
      EXPECT_LT((a.at(u * e.length).position() - b.at((1 - u) * e.length).position()).norm(), 1e-11);
    }
  }
}

TEST(MaxAbsCurvature, MatchesDenseSampling) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const Elastica e = random_short_elastica(random);
    double dense = 0;
    for (const CurvePoint& p : sample(e, 4001)) dense = std::max(dense, std::abs(p.kappa));
    const double exact = ElasticaCurve(e).max_abs_curvature();
    EXPECT_GE(exact, dense * (1 - 1e-12));
    EXPECT_NEAR(exact, dense, 1e-5 * dense + 1e-9);
  }
}

TEST(TurnsAtMost, BoundsTheTurningOfInflectionalAndWindingCurves) {
  for (const Elastica& e : {Elastica{0, 0, 0.3, 0.02, 1e-4, 3e-5, 800},
                            {1, 2, 2.0, 0.3, 1e-3, 0, 100},
                            {1, 2, 3.0, -0.1, 0, 0, 100},
                            {0, 0, 0, 1e-3, -2e-4, 0, 500}}) {
    double turned = 0;
    const std::vector<CurvePoint> on = sample(e, 2001);
    for (std::size_t i = 1; i < on.size(); ++i) turned += std::abs(on[i].theta - on[i - 1].theta);
    EXPECT_LE(turned, turns_at_most(e, e.length) * (1 + 1e-12));
    EXPECT_GT(turned, 0.1 * turns_at_most(e, e.length));
  }
  EXPECT_TRUE(std::isnan(turns_at_most({0, 0, 0, std::nan(""), 0, 0, 1}, 1)));
}

TEST(ElasticaCurve, RejectsWhatIsNotACurve) {
  EXPECT_THROW(ElasticaCurve({0, 0, 0, 0, 0, 0, -1}), std::logic_error);
  EXPECT_THROW(ElasticaCurve({0, 0, std::nan(""), 0, 0, 0, 1}), std::logic_error);
  EXPECT_THROW(ElasticaCurve({0, 0, 0, 1e9, 0, 0, 1}), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
