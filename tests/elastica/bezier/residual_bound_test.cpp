// The lambda-residual is off by no more than its bound, against adaptive quadrature on random cubics of every
// kind: some in every run, as many as HOTBLADE_RESIDUAL_CUBICS says otherwise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/bezier/residual_batch.hpp"
#include "tests/elastica/bezier/residual_cubics.hpp"
#include "tests/elastica/bezier/residual_oracle.hpp"

namespace hotblade::elastica {
namespace {

std::size_t cubics_to_check() {
  const char* wanted = std::getenv("HOTBLADE_RESIDUAL_CUBICS");
  return wanted ? std::stoul(wanted) : 1000;
}

struct Judged {
  Bezier bezier;
  LambdaResidual residual;
  double truth = 0;  // 0 without a value
};

const std::vector<Judged>& cases() {
  static const std::vector<Judged> all = [] {
    RandomCubics cubics(11);
    std::vector<Judged> cases(cubics_to_check());
    for (Judged& c : cases) {
      c.bezier = cubics.next();
      c.residual = lambda_residual(c.bezier);
      if (c.residual.status == ResidualStatus::kOk) c.truth = ResidualOracle(c.bezier).value();
    }
    return cases;
  }();
  return all;
}

double of_all(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values.at(static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

std::string shown(const Bezier& b) {
  std::string text;
  char number[32];
  for (const Eigen::Vector2d& p : b) {
    for (const double c : {p.x(), p.y()}) {
      std::snprintf(number, sizeof number, "%.17g ", c);
      text += number;
    }
  }
  return text;
}

TEST(LambdaResidualBound, IsNeverExceeded) {
  std::vector<double> bounds, errors;
  double worst = 0;
  for (const Judged& c : cases()) {
    if (c.residual.status != ResidualStatus::kOk) continue;
    const double error = std::abs(c.residual.value - c.truth);
    EXPECT_LE(error, c.residual.bound) << c.truth << ", " << shown(c.bezier);
    bounds.push_back(c.residual.bound);
    errors.push_back(error);
    worst = std::max(worst, error / c.residual.bound);
  }
  ASSERT_GT(bounds.size(), cases().size() * 9 / 10);
  std::printf(
      "%zu cubics: bound median %.1e, p99 %.1e, max %.1e; error median %.1e, p99 %.1e, max %.1e; "
      "at most %.2f of the bound\n",
      bounds.size(), of_all(bounds, 0.5), of_all(bounds, 0.99), of_all(bounds, 1), of_all(errors, 0.5),
      of_all(errors, 0.99), of_all(errors, 1), worst);
  // Of use: no digit that a threshold of 0.22 looks at.
  EXPECT_LE(of_all(bounds, 0.5), 1e-11);
  EXPECT_LE(of_all(bounds, 0.99), 1e-7);
  EXPECT_LE(of_all(bounds, 1), 1e-4);
}

TEST(LambdaResidualBound, OfOrdinaryCubicsIsBelowAMillionthOfThem) {
  RandomCubics cubics(12);
  std::vector<double> relative;
  for (int i = 0; i < 2000; ++i) {
    const LambdaResidual r = lambda_residual(cubics.ordinary());
    ASSERT_EQ(r.status, ResidualStatus::kOk);
    relative.push_back(r.bound / r.value);
  }
  EXPECT_LE(of_all(relative, 0.5), 1e-10);
  EXPECT_LE(of_all(relative, 1), 1e-6);
}

// 24 nodes give 0.28 where adaptive quadrature gives 1.00.
TEST(LambdaResidualBound, OfANearCuspHoldsWhereOneRuleFails) {
  RandomCubics cubics(13);
  for (int i = 0; i < 100; ++i) {
    const Bezier b = cubics.near_cusp();
    const LambdaResidual r = lambda_residual(b);
    EXPECT_NEAR(r.value, ResidualOracle(b).value(), std::min(1e-8, r.bound)) << shown(b);
  }
}

// Quadratic Beziers as CAD raises them: their derivative has one root only, and no cusp inside.
TEST(LambdaResidualBound, OfAParabolaIsThatOfAnOrdinaryCubic) {
  std::mt19937 random(14);
  // Multiples of three, so that the raised control points are exact, and so is the missing third power.
  std::uniform_int_distribution<int> third(-40, 40);
  const auto place = [&] { return Eigen::Vector2d(3 * third(random), 3 * third(random)); };
  std::vector<Bezier> parabolas{Bezier{Eigen::Vector2d(0, 0), {1, 1}, {2, 1}, {3, 0}}};
  while (parabolas.size() < 500) {
    const Eigen::Vector2d a = place(), m = place(), b = place();
    const Eigen::Vector2d to = m - a, on = b - m;
    // No hairpin: its tip is a near cusp, which other tests are for.
    if (to.norm() < 9 || on.norm() < 9 || to.dot(on) < 0) continue;
    if (std::abs(to.x() * on.y() - to.y() * on.x()) < 0.1 * to.norm() * on.norm()) continue;
    parabolas.push_back({a, (a + 2 * m) / 3, (2 * m + b) / 3, b});
  }
  for (const Bezier& b : parabolas) {
    const LambdaResidual r = lambda_residual(b);
    ASSERT_EQ(r.status, ResidualStatus::kOk) << shown(b);
    EXPECT_LE(r.bound, 1e-6) << shown(b);
    EXPECT_NEAR(r.value, ResidualOracle(b).value(), r.bound) << shown(b);
  }
}

TEST(LambdaResidualBound, OfACurveWithoutAValueIsZero) {
  const Eigen::Vector2d p(1, 2);
  EXPECT_EQ(lambda_residual({p, p, {3, 5}, {4, 2}}).bound, 0);
  EXPECT_EQ(lambda_residual({p, {2, 4}, {3, 6}, {4, 8}}).bound, 0);
}

class ResidualBoundOnEverySimd : public testing::TestWithParam<Simd> {
  void SetUp() override {
    if (!supported(GetParam())) GTEST_SKIP() << "this machine lacks the instruction set";
  }
};
INSTANTIATE_TEST_SUITE_P(, ResidualBoundOnEverySimd,
                         testing::Values(Simd::kBaseline, Simd::kAvx2, Simd::kAvx512));

TEST_P(ResidualBoundOnEverySimd, IsNeverExceededInABatch) {
  std::array<std::vector<double>, 8> columns;
  for (const Judged& c : cases()) {
    for (std::size_t k = 0; k < 8; ++k) columns[k].push_back(c.bezier[k / 2][static_cast<int>(k % 2)]);
  }
  const std::size_t n = cases().size();
  std::vector<double> e(n), bound(n);
  std::vector<ResidualStatus> status(n);
  lambda_residuals(
      {columns[0], columns[1], columns[2], columns[3], columns[4], columns[5], columns[6], columns[7]},
      {e, status, bound}, GetParam());
  double worst = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Judged& c = cases()[i];
    EXPECT_EQ(status[i], c.residual.status) << shown(c.bezier);
    EXPECT_LE(std::abs(e[i] - c.truth), bound[i]) << c.truth << ", " << shown(c.bezier);
    if (bound[i] > 0) worst = std::max(worst, std::abs(e[i] - c.truth) / bound[i]);
  }
  std::printf("at most %.2f of the bound\n", worst);
}

// Edges and their gradients take panels as curves do.
TEST_P(ResidualBoundOnEverySimd, OfEdgesIsThatOfTheirCurve) {
  std::mt19937_64 random(14);
  std::uniform_real_distribution<double> angle(-3, 3), digits(-4, 0.3);
  std::vector<double> a1, a2, l1, l2;
  for (int i = 0; i < 300; ++i) {
    a1.push_back(angle(random));
    a2.push_back(angle(random));
    l1.push_back(std::pow(10, digits(random)));
    l2.push_back(std::pow(10, digits(random)));
  }
  const std::size_t n = a1.size();
  std::vector<double> e(n), bound(n), by_l1(n), by_l2(n), plain(n), plain_bound(n);
  std::vector<ResidualStatus> status(n);
  lambda_residuals(EdgeBatch{a1, a2, l1, l2}, {plain, status, plain_bound}, GetParam());
  lambda_residual_gradients({a1, a2, l1, l2}, {e, status, bound}, by_l1, by_l2, GetParam());
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_EQ(status[i], ResidualStatus::kOk);
    const Eigen::Vector2d first(std::cos(a1[i]), std::sin(a1[i])), last(std::cos(a2[i]), std::sin(a2[i]));
    const double truth =
        ResidualOracle({Eigen::Vector2d(0, 0), l1[i] * first, Eigen::Vector2d(1, 0) + l2[i] * last, {1, 0}})
            .value();
    // The sines and products that make the curve of the edges round too.
    const double rounding = 1e-11;
    EXPECT_NEAR(plain[i], truth, plain_bound[i] + rounding) << i;
    EXPECT_NEAR(e[i], truth, bound[i] + rounding) << i;
    EXPECT_LE(bound[i], 1e-7);
  }
}

}  // namespace
}  // namespace hotblade::elastica
