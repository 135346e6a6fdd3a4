#include "elastica/blade/end_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "elastica/blade/stability.hpp"

namespace hotblade::elastica {
namespace {

Eigen::Vector3d end_of(const Elastica& e) {
  const CurvePoint p = ElasticaCurve(e).at(e.length);
  return {p.x, p.y, p.theta};
}

Elastica random_blade(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> u(-1, 1);
  return {
      u(random), u(random), 3 * u(random), size * 4 * u(random), size * 40 * u(random), size * 40 * u(random),
      1};
}

TEST(EndMap, HasTheCurvesOwnEnd) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Elastica e = random_blade(random, 1);
    const CurvePoint p = end_map(e).point;
    EXPECT_LT((Eigen::Vector3d(p.x, p.y, p.theta) - end_of(e)).norm(), 1e-12);
  }
}

TEST(EndMap, IsTheSameOnEveryInstructionSetToRounding) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Elastica e = random_blade(random, trial % 2 == 0 ? 1 : 1e-3);
    const std::vector<JacobiFields> plain = jacobi_fields(e, 1, Simd::kBaseline);
    for (const Simd simd : {Simd::kAvx2, Simd::kAvx512}) {
      if (!supported(simd)) continue;
      const std::vector<JacobiFields> wide = jacobi_fields(e, 1, simd);
      ASSERT_EQ(wide.size(), plain.size());
      for (std::size_t i = 0; i < wide.size(); ++i) {
        EXPECT_LT((wide[i].fields - plain[i].fields).norm(), 1e-13 * (1 + plain[i].fields.norm()));
        EXPECT_LT((wide[i].rates - plain[i].rates).norm(), 1e-13 * (1 + plain[i].rates.norm()));
        EXPECT_EQ(wide[i].index, plain[i].index);
      }
      EXPECT_EQ(end_map(e, Exactness::kRounding, simd).fields, wide.back().fields);
      EXPECT_EQ(end_map(e, Exactness::kRounding, simd).index, wide.back().index);
    }
  }
}

TEST(EndMap, OfASearchIsWithinItsBound) {
  std::mt19937_64 random(4);
  double worst = 0, worst_fields = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Elastica e = random_blade(random, trial % 2 == 0 ? 1 : 0.1);
    const JacobiFields exact = end_map(e), search = end_map(e, Exactness::kSearch);
    const CurvePoint &p = exact.point, &q = search.point;
    worst = std::max({worst, std::hypot(q.x - p.x, q.y - p.y), std::abs(q.theta - p.theta)});
    const double size = 1 + exact.fields.norm();
    worst_fields = std::max(worst_fields, (search.fields - exact.fields).norm() / size);
    // Of two blades of rounding's distance from a fold one may hold.
    if (std::abs(exact.fields.determinant()) > 1e-7 * size) {
      EXPECT_EQ(search.index, exact.index) << trial;
    }
  }
  EXPECT_LT(worst, 1e-8);
  EXPECT_LT(worst_fields, 1e-8);
}

TEST(EndMap, DerivativesAgreeWithCentralDifferences) {
  std::mt19937_64 random(2);
  for (const double size : {1.0, 1e-3, 0.0}) {  // lines and circles included: nothing special happens there
    for (int trial = 0; trial < 30; ++trial) {
      const Elastica e = random_blade(random, size);
      const Eigen::Matrix3d fields = end_map(e).fields;
      constexpr double kStep = 1e-5;  // error about step^2 + rounding / step
      for (int i = 0; i < 3; ++i) {
        Elastica low = e, high = e;
        double Elastica::*const unknowns[] = {&Elastica::kappa, &Elastica::lambda1, &Elastica::lambda2};
        low.*unknowns[i] -= kStep;
        high.*unknowns[i] += kStep;
        const Eigen::Vector3d slope = (end_of(high) - end_of(low)) / (2 * kStep);
        EXPECT_LT((slope - fields.col(i)).norm(), 1e-8 * (1 + slope.norm()));
      }
    }
  }
}

// Closed forms, by differentiating the symmetries of the family (docs/elastica.md): sliding along the curve,
// turning, scaling, and a change of modulus, in a frame with the force along x. Singular for lambda = 0 and k
// = 1.
Eigen::Matrix<double, 3, 4> closed_fields(const CurvePoint& a, const CurvePoint& p, double s, double lambda,
                                          Eigen::Matrix4d* sources) {
  const double c = 0.5 * a.kappa * a.kappa - lambda * std::cos(a.theta);
  const double x = p.x - a.x, y = p.y - a.y;
  const double co = std::cos(p.theta), si = std::sin(p.theta), co0 = std::cos(a.theta),
               si0 = std::sin(a.theta);
  Eigen::Matrix<double, 3, 4> f;
  f.col(0) << co - co0, si - si0, p.kappa;
  f.col(1) << -y, x, 1;
  f.col(2) << s * co - x, s * si - y, s * p.kappa;
  const double square = (p.kappa * si - a.kappa * si0 - 2 * c * x) / lambda - s;  // Int 3 cos^2 - 2
  const auto primitive = [&](double kappa) {
    return -(kappa * kappa * kappa / 6 - c * kappa) / (lambda * lambda);
  };
  const double product = primitive(p.kappa) - primitive(a.kappa);  // Int sin cos
  f.col(3) << -x * co + square - c / lambda * (s * co - x), 3 * product - x * si - c / lambda * (s * si - y),
      2 * si - x * p.kappa - c / lambda * s * p.kappa;
  // (d theta, d theta', d lambda1, d lambda2) of each at the start.
  const double bend = -lambda * si0;
  *sources << a.kappa, 1, 0, 2 * si0, bend, 0, a.kappa, co0 * a.kappa - c / lambda * a.kappa, 0, 0,
      2 * lambda, 0, 0, lambda, 0, 0;
  return f;
}

TEST(EndMap, JacobiFieldsAgreeWithTheirClosedForms) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int trial = 0; trial < 40; ++trial) {
    const double lambda = 5 + 20 * std::abs(u(random));
    const Elastica e{0, 0, 3 * u(random), 5 * u(random), lambda, 0, 1.5};
    for (const JacobiFields& f : jacobi_fields(e)) {
      Eigen::Matrix4d sources;
      const auto closed = closed_fields({0, 0, e.theta, e.kappa}, f.point, f.s, lambda, &sources);
      // The combination with d theta = 0 and one of d kappa, d lambda1, d lambda2 equal to 1 at the start.
      const Eigen::Matrix<double, 4, 3> mix =
          sources.fullPivLu().solve(Eigen::Matrix<double, 4, 3>(Eigen::Matrix4d::Identity().rightCols(3)));
      const Eigen::Matrix3d expected = closed * mix;
      EXPECT_LT((expected - f.fields).norm(), 1e-9 * (1 + mix.norm())) << trial;
    }
  }
}

TEST(EndMap, IndexIsTheNumberOfNegativeEigenvaluesOfTheSecondVariation) {
  std::mt19937_64 random(4);
  int stable = 0, unstable = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Elastica e = random_blade(random, 1.5);
    const double margin = stability_margin(e);
    if (std::abs(margin) < 0.02) continue;  // 128 cells cannot tell
    EXPECT_EQ(end_map(e).index == 0, margin > 0) << trial << " " << margin;
    (margin > 0 ? stable : unstable) += 1;
  }
  EXPECT_GT(stable, 50);
  EXPECT_GT(unstable, 50);
}

TEST(EndMap, IndexGrowsAlongTheCurveAndOnlyWhereTheDeterminantVanishes) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const auto all = jacobi_fields(random_blade(random, 3));
    for (std::size_t i = 1; i < all.size(); ++i) {
      EXPECT_GE(all[i].index, all[i - 1].index);
      const bool odd = (all[i].index - all[i - 1].index) % 2 != 0;
      EXPECT_EQ(odd, all[i].fields.determinant() * all[i - 1].fields.determinant() < 0);
    }
  }
}

TEST(EndMap, ACompressedLineBucklesAtEulersClampedLoad) {
  const double euler = 4 * M_PI * M_PI;
  EXPECT_EQ(end_map({0, 0, 0.4, 0, 0, 0, 1}).index, 0);
  for (const double angle : {0.0, 0.7}) {
    const double c = std::cos(angle), s = std::sin(angle);
    EXPECT_EQ(end_map({0, 0, angle, 0, 0.999 * euler * c, 0.999 * euler * s, 1}).index, 0);
    EXPECT_EQ(end_map({0, 0, angle, 0, 1.001 * euler * c, 1.001 * euler * s, 1}).index, 1);
  }
}

TEST(EndMap, RefusesWhatCannotBeEvaluated) {
  EXPECT_THROW((void)end_map({0, 0, 0, 1, 0, 0, 0}), std::logic_error);
  EXPECT_THROW((void)end_map({0, 0, 0, NAN, 0, 0, 1}), std::logic_error);
  EXPECT_THROW((void)end_map({0, 0, 0, 1e9, 0, 0, 1}), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
