#include "elastica/curve/closed_form.hpp"

#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace hotblade::elastica {
namespace {

using Wide = boost::multiprecision::cpp_bin_float_50;

struct Reference {
  double sn, cn, dn, e;
};

// By Boost with 50 digits, k <= 1: E through the incomplete integral at the amplitude.
Reference below_one(const Wide& k, const Wide& u, Wide* dn_minus = nullptr) {
  Wide cn, dn;
  const Wide sn = boost::math::jacobi_elliptic(k, u, &cn, &dn);
  const Wide pi = boost::math::constants::pi<Wide>();
  Wide amplitude = atan2(sn, cn);
  if (k < 1) {
    const Wide mean = u * pi / (2 * boost::math::ellint_1(k));
    amplitude += 2 * pi * round((mean - amplitude) / (2 * pi));
  }
  const Wide e = k < 1 ? Wide(boost::math::ellint_2(k, amplitude)) : Wide(tanh(u));
  if (dn_minus) *dn_minus = e;
  return {static_cast<double>(sn), static_cast<double>(cn), static_cast<double>(dn), static_cast<double>(e)};
}

Reference reference(double modulus, double argument) {
  const Wide k = modulus, u = argument;
  if (modulus <= 1) return below_one(k, u);
  Wide e = 0;
  const Reference r = below_one(1 / k, k * u, &e);
  // Int dn(u,k)^2 = Int cn(ku,1/k)^2 du
  const Wide integral = k * (e - (1 - 1 / (k * k)) * k * u);
  return {static_cast<double>(Wide(r.sn) / k), r.dn, r.cn, static_cast<double>(integral)};
}

double largest_error(double modulus, const std::vector<double>& u, Simd simd) {
  const Jacobi jacobi(modulus);
  std::vector<double> sn(u.size()), cn(u.size()), dn(u.size()), e(u.size());
  jacobi.sample(u, {sn, cn, dn, e}, simd);
  double worst = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Reference r = reference(modulus, u[i]);
    const double size = std::max(1.0, std::abs(u[i]));
    worst = std::max({worst, std::abs(cn[i] - r.cn) / size, std::abs(dn[i] - r.dn) / size,
                      std::abs(sn[i] - r.sn) * std::max(1.0, modulus) / size});
    // E against the arc length: for k > 1 arc lengths are of the order of 1/k.
    worst = std::max(worst, std::abs(e[i] - r.e) / std::max(std::abs(u[i]), 1 / std::max(1.0, modulus)));
  }
  return worst;
}

std::vector<double> three_periods(double modulus, std::mt19937_64& random, int count) {
  const double period = Jacobi(modulus).period();
  std::uniform_real_distribution<double> share(-1, 1);
  std::vector<double> u{0};
  while (static_cast<int>(u.size()) < count)
    u.push_back(3 * (std::isinf(period) ? 20 : period) * share(random));
  return u;
}

TEST(Jacobi, AgreesWithFiftyDigitsOverEveryModulusAndThreePeriods) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-6, 6), unit(0, 1);
  std::vector<double> moduli{
      0,        1e-300, 1e-9, 0.5, 1 - 1e-9, std::nextafter(1.0, 0.0), 1, std::nextafter(1.0, 2.0),
      1 + 1e-9, 2,      1e6};
  for (int i = 0; i < 10; ++i) {
    moduli.push_back(std::pow(10, exponent(random)));
    moduli.push_back(unit(random));
    moduli.push_back(1 + std::pow(10, -2 * std::abs(exponent(random))));
    moduli.push_back(1 - std::pow(10, -2 * std::abs(exponent(random))));
  }
  for (const double k : moduli) {
    EXPECT_LT(largest_error(k, three_periods(k, random, 12), best_simd()), 1e-13) << k;
  }
}

class JacobiOnEverySimd : public testing::TestWithParam<Simd> {
  void SetUp() override {
    if (!supported(GetParam())) GTEST_SKIP() << "this machine lacks the instruction set";
  }
};
INSTANTIATE_TEST_SUITE_P(Jacobi, JacobiOnEverySimd,
                         testing::Values(Simd::kBaseline, Simd::kAvx2, Simd::kAvx512));

TEST_P(JacobiOnEverySimd, AgreesWithFiftyDigits) {
  std::mt19937_64 random(2);
  for (const double k : {0.2, 0.9, 0.99999, 1.0, 1.3, 50.0}) {
    EXPECT_LT(largest_error(k, three_periods(k, random, 19), GetParam()), 1e-13) << k;
  }
}

TEST_P(JacobiOnEverySimd, HoldsTheIdentitiesAndTheDifferentialEquation) {
  std::mt19937_64 random(3);
  for (const double k : {0.0, 0.3, 0.999, 1.0, 1.001, 7.0, 4e5}) {
    const std::vector<double> u = three_periods(k, random, 40);
    const std::size_t n = u.size();
    std::vector<double> sn(n), cn(n), dn(n), e(n);
    Jacobi(k).sample(u, {sn, cn, dn, e}, GetParam());
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(sn[i] * sn[i] + cn[i] * cn[i], 1, 1e-14);
      EXPECT_NEAR(dn[i] * dn[i] + k * k * sn[i] * sn[i], 1, 1e-14);
    }
  }
}

Elastica random_elastica(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  return {100 * u(random), 100 * u(random), 3 * u(random), 3 * u(random),
          20 * u(random),  20 * u(random),  4 + u(random)};
}

void expect_same_curve(const Elastica& e, double tolerance) {
  const auto closed = ClosedForm::of(e);
  ASSERT_TRUE(closed);
  const ElasticaCurve taylor(e);
  std::vector<double> s(33);
  for (std::size_t i = 0; i < s.size(); ++i) s[i] = e.length * static_cast<double>(i) / 32;
  const std::size_t n = s.size();
  std::vector<double> x(n), y(n), tx(n), ty(n), kappa(n);
  closed->sample(s, {x, y, tx, ty, kappa});
  const double peak = taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2);
  for (std::size_t i = 0; i < n; ++i) {
    const CurvePoint a = taylor.at(s[i]), b = closed->at(s[i]);
    const double scale = tolerance * (e.length + std::hypot(e.x, e.y));
    EXPECT_NEAR(a.x, x[i], scale) << closed->shape().modulus << " at " << s[i];
    EXPECT_NEAR(a.y, y[i], scale) << closed->shape().modulus << " at " << s[i];
    EXPECT_NEAR(b.x, x[i], 1e-13 * (e.length + std::abs(e.x)));
    EXPECT_NEAR(a.theta, b.theta, tolerance * e.length * peak) << closed->shape().modulus << " at " << s[i];
    EXPECT_NEAR(std::cos(a.theta), tx[i], tolerance * e.length * peak);
    EXPECT_NEAR(std::sin(a.theta), ty[i], tolerance * e.length * peak);
    EXPECT_NEAR(a.kappa, kappa[i], tolerance * e.length * peak * peak);
    EXPECT_NEAR(b.kappa, kappa[i], 1e-12 * peak);
  }
}

TEST(ClosedForm, AgreesWithTheTaylorPieces) {
  std::mt19937_64 random(4);
  int inflectional = 0, winding = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Elastica e = random_elastica(random);
    ++(ClosedForm::of(e)->shape().regime == Regime::kWinding ? winding : inflectional);
    expect_same_curve(e, 1e-11);
  }
  EXPECT_GT(inflectional, 50);
  EXPECT_GT(winding, 25);
}

// xi_k itself, whose vertex curvature is 2k for lambda1 = 1: with 50 digits, against the arc length.
TEST(ClosedForm, AgreesWithFiftyDigitsOverEveryModulusAndThreePeriods) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-6, 6), unit(0, 1);
  std::vector<double> moduli{0.5, 1 - 1e-15, 1 + 1e-15, 1, 1e6};
  for (int i = 0; i < 12; ++i) {
    moduli.push_back(std::pow(10, exponent(random)));
    moduli.push_back(unit(random));
    moduli.push_back(1 + (unit(random) - 0.5) * std::pow(10, -2 * std::abs(exponent(random))));
  }
  for (const double k : moduli) {
    const double period = Jacobi(k).period(), length = 3 * (std::isinf(period) ? 20 : period);
    const auto closed = ClosedForm::of({0, 0, 0, 2 * k, 1, 0, length});
    ASSERT_TRUE(closed);
    for (int i = 0; i < 8; ++i) {
      const double s = length * unit(random);
      const CurvePoint p = closed->at(s);
      const Reference r = reference(k, s);
      // 1 - cn from sn^2, which the reference keeps to its last digit.
      const double rise = 2 * k * (r.cn > 0 ? r.sn * r.sn / (1 + r.cn) : 1 - r.cn);
      EXPECT_NEAR(p.x, 2 * r.e - s, 1e-13 * length) << k << " at " << s;
      EXPECT_NEAR(p.y, rise, 1e-13 * length) << k << " at " << s;
      EXPECT_NEAR(p.kappa, 2 * k * r.cn, 2e-13 * k * std::max(1.0, length)) << k << " at " << s;
    }
  }
}

// Near the separatrix 1 - k of either sign down to rounding, near the circle lambda -> 0, near the line k ->
// 0. A curve that nears the separatrix' asymptote loses digits as exp(s) in any forward integration: 2e-13 a
// Taylor piece become 1e-9 there.
TEST(ClosedForm, AgreesWithTheTaylorPiecesNearEveryBorder) {
  for (int i = 1; i <= 15; ++i) {
    const double small = std::pow(10, -i);
    expect_same_curve({1, 2, 0, 2 * (1 - small), 1, 0, 9}, 1e-9);
    expect_same_curve({1, 2, 0, 2 * (1 + small), 1, 0, 9}, 1e-9);
    expect_same_curve({1, 2, 0.7, 2, small, 2 * small, 6}, 1e-12);
    expect_same_curve({1, 2, 0.7, -2, small, 2 * small, 6}, 1e-12);
    expect_same_curve({1, 2, small, -small, 1, 0, 9}, 1e-12);
  }
  expect_same_curve({1, 2, 0, 2, 1, 0, 9}, 1e-9);
  expect_same_curve({1, 2, 0.7, -2, 0, 0, 6}, 1e-12);
  expect_same_curve({0, 0, std::numbers::pi, 0, 1, 0, 5}, 1e-12);
}

TEST(ClosedForm, IsAbsentWhereACurveHardlyTurns) {
  EXPECT_FALSE(ClosedForm::of({1, 2, 0.3, 0, 0, 0, 1000}));
  EXPECT_FALSE(ClosedForm::of({1, 2, 0.3, 1e-9, 1e-12, 0, 1000}));
  EXPECT_THROW((void)ClosedForm::of({1, 2, std::nan(""), 0, 0, 0, 1}), std::logic_error);
  EXPECT_THROW((void)ClosedForm::of({1, 2, 0, 0, 0, 0, -1}), std::logic_error);
}

TEST(ClosedForm, GivesTheStateFormBack) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 300; ++trial) {
    const Elastica e = random_elastica(random), back = ClosedForm::of(e)->state();
    EXPECT_NEAR(back.x, e.x, 1e-12);
    EXPECT_NEAR(back.theta, e.theta, 1e-13);
    EXPECT_NEAR(back.kappa, e.kappa, 1e-11);
    EXPECT_NEAR(back.lambda1, e.lambda1, 1e-11);
    EXPECT_NEAR(back.lambda2, e.lambda2, 1e-11);
  }
}

TEST(ClosedForm, RepeatsItsCurvatureAfterAPeriod) {
  std::mt19937_64 random(6);
  for (int trial = 0; trial < 100; ++trial) {
    const auto c = ClosedForm::of(random_elastica(random));
    const double p = c->period();
    EXPECT_NEAR(c->at(0.3).kappa, c->at(0.3 + p).kappa, 1e-10);
    EXPECT_GT(std::abs(c->at(0.3).kappa - c->at(0.3 + 0.37 * p).kappa), 1e-9);
  }
}

TEST(SamplePoints, CoversCurvesWithAndWithoutAClosedForm) {
  const std::vector<double> s{0, 1, 2, 3};
  for (const Elastica& e : {Elastica{1, 2, 0.3, 0, 0, 0, 3}, Elastica{1, 2, 0.3, 0.4, 2, -1, 3}}) {
    std::vector<double> x(4), kappa(4);
    sample_points(e, s, {x, {}, {}, {}, kappa});
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(x[i], point_at(e, s[i]).x, 1e-12);
      EXPECT_NEAR(kappa[i], point_at(e, s[i]).kappa, 1e-11);
    }
  }
}

}  // namespace
}  // namespace hotblade::elastica
