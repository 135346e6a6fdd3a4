#include "elastica/fit/fit_bezier.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/bezier/standard_position.hpp"
#include "elastica/fit/fit_lanes.hpp"

namespace hotblade::elastica {
namespace {

using std::numbers::pi;

// Cubics under the paper's angle constraints and edge lengths, e <= 0.4, in random places and sizes.
std::vector<Bezier> constrained_curves(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Bezier> curves;
  while (curves.size() < n) {
    const double beta1 = pi + u(random) * 2 * pi / 3, beta2 = pi + u(random) * 2 * pi / 3;
    if (std::abs(beta1 - beta2) >= 0.4 * pi) continue;
    StandardPosition s{pi - beta1, wrapped(beta2), 0, 0};
    const double d = std::copysign(s.a1 - s.a2, s.a2 * (s.a1 - s.a2)) / pi;
    const double low = std::max(0.4 * (1 + 6 * d), 0.27), high = std::max(1.2 * (1 + 5 * d), 0.58);
    if (high < low) continue;
    s.l1 = low + 0.5 * (high - low) * (u(random) + 1);
    s.l2 = low + 0.5 * (high - low) * (u(random) + 1);
    Bezier b = to_bezier(s);
    if (lambda_residual(b).value > 0.4) continue;
    const double turn = pi * u(random), size = 500 * std::exp(u(random));
    const Eigen::Vector2d shift(1000 * u(random), 1000 * u(random));
    for (Eigen::Vector2d& p : b) {
      p = shift + size * Eigen::Vector2d(std::cos(turn) * p.x() - std::sin(turn) * p.y(),
                                         std::sin(turn) * p.x() + std::cos(turn) * p.y());
    }
    curves.push_back(b);
  }
  return curves;
}

// The paper's L2 by brute force: 2,000 midpoints, curves evaluated by other code.
double dense_l2(const Bezier& b, const Elastica& e, double* angle2 = nullptr) {
  constexpr int kPieces = 2000;
  const std::vector<double> t = even_parameters(b, 2 * kPieces + 1);
  const double length = arc_lengths(b, 256).back();
  const ElasticaCurve curve(e);
  double sum = 0, angles = 0;
  for (std::size_t i = 0; i < kPieces; ++i) {
    const BezierPoint p = evaluate(b, t[2 * i + 1]);
    const CurvePoint q = curve.at(e.length * (static_cast<double>(i) + 0.5) / kPieces);
    sum += (p.p - q.position()).squaredNorm();
    const Eigen::Vector2d g = q.tangent();
    const double angle = std::atan2(p.d1.x() * g.y() - p.d1.y() * g.x(), p.d1.dot(g));
    angles += angle * angle;
  }
  if (angle2) *angle2 = angles / kPieces;
  return std::sqrt(sum / kPieces) / length;
}

TEST(FitBezierElastica, ReportsThePapersDistances) {
  const auto curves = constrained_curves(100, 1);
  for (const Bezier& b : curves) {
    const BezierElasticaFit fit = fit_bezier_elastica(b);
    ASSERT_EQ(fit.status, FitStatus::kOk);
    double angle2 = 0;
    const double l2 = dense_l2(b, fit.elastica, &angle2);
    EXPECT_NEAR(fit.l2, l2, 1e-3 * l2 + 1e-6);
    EXPECT_NEAR(fit.h1, std::sqrt(l2 * l2 + angle2), 2e-3 * fit.h1 + 1e-6);
  }
}

TEST(FitBezierElastica, IsALocalMinimumOfTheDistance) {
  const auto curves = constrained_curves(20, 2);
  for (const Bezier& b : curves) {
    const Elastica e = fit_bezier_elastica(b).elastica;
    const double at = dense_l2(b, e), n = e.length;
    for (double Elastica::*const member : {&Elastica::x, &Elastica::y, &Elastica::theta, &Elastica::kappa,
                                           &Elastica::lambda1, &Elastica::lambda2, &Elastica::length}) {
      double unit = n;
      if (member == &Elastica::theta) unit = 1;
      if (member == &Elastica::kappa) unit = 1 / n;
      if (member == &Elastica::lambda1 || member == &Elastica::lambda2) unit = 10 / (n * n);
      for (const double step : {1e-3, -1e-3}) {
        Elastica moved = e;
        moved.*member += step * unit;
        EXPECT_GT(dense_l2(b, moved), at);
      }
    }
  }
}

TEST(FitBezierElastica, FindsTheMinimumOfAllStartsWithinThePapersConstraints) {
  const auto curves = constrained_curves(800, 3);
  const auto quick = fit_bezier_elastica(curves);
  const auto thorough = fit_bezier_elastica(curves, {.all_starts = true});
  std::vector<double> l2;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    EXPECT_EQ(quick[i].status, FitStatus::kOk);
    EXPECT_EQ(thorough[i].starts_tried, 14);
    EXPECT_LE(quick[i].l2, thorough[i].l2 * (1 + 1e-6) + 1e-9) << i;
    l2.push_back(quick[i].l2);
  }
  std::sort(l2.begin(), l2.end());
  EXPECT_LT(l2.back(), 0.011);
  EXPECT_LT(l2[l2.size() * 99 / 100], 0.009);
}

TEST(FitBezierElastica, LooksAgainWhereTheFirstAnswerIsDoubtful) {
  // Four points anywhere in the disc, loops and near-cusps too.
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Bezier> curves(300);
  for (Bezier& b : curves) {
    for (Eigen::Vector2d& p : b) p = {u(random), u(random)};
  }
  const auto quick = fit_bezier_elastica(curves);
  const auto thorough = fit_bezier_elastica(curves, {.all_starts = true});
  int again = 0, worse = 0;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    again += quick[i].starts_tried > 1;
    worse += quick[i].l2 > thorough[i].l2 * (1 + 1e-3) + 1e-9;
  }
  EXPECT_GT(again, 5);
  EXPECT_LE(worse, 3);
}

TEST(FitBezierElastica, DoesNotDependOnCompany) {
  const auto curves = constrained_curves(150, 5);
  const auto together = fit_bezier_elastica(curves);
  for (std::size_t i = 0; i < curves.size(); i += 7) {
    const BezierElasticaFit alone = fit_bezier_elastica(curves[i]);
    EXPECT_EQ(std::memcmp(&alone.elastica, &together[i].elastica, sizeof(Elastica)), 0) << i;
    EXPECT_EQ(alone.l2, together[i].l2);
  }
}

TEST(FitBezierElastica, MirrorsReversesAndScalesWithItsCurve) {
  for (const Bezier& b : constrained_curves(50, 6)) {
    Bezier other;
    for (std::size_t i = 0; i < 4; ++i) other[i] = 3.5 * Eigen::Vector2d(b[3 - i].x(), -b[3 - i].y());
    const BezierElasticaFit one = fit_bezier_elastica(b), two = fit_bezier_elastica(other);
    EXPECT_NEAR(one.l2, two.l2, 1e-6 * one.l2 + 1e-9);
    EXPECT_NEAR(3.5 * one.elastica.length, two.elastica.length, 1e-5 * two.elastica.length);
  }
}

TEST(FitBezierElastica, TakesLinesForWhatTheyAre) {
  const Bezier line{Eigen::Vector2d(1, 2), {2, 4}, {4, 8}, {5, 10}};
  const BezierElasticaFit fit = fit_bezier_elastica(line);
  EXPECT_EQ(fit.status, FitStatus::kOk);
  EXPECT_LT(fit.l2, 1e-9);
  EXPECT_NEAR(fit.elastica.length, std::sqrt(80.0), 1e-8);
  EXPECT_NEAR(fit.elastica.kappa, 0, 1e-8);
}

TEST(FitBezierElastica, RefusesCuspsPointsAndNonsense) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector2d o(0, 0);
  for (const Bezier& b : {Bezier{o, o, o, o}, Bezier{o, o, Eigen::Vector2d(1, 1), {2, 0}},
                          Bezier{o, Eigen::Vector2d(nan, 0), {1, 1}, {2, 0}},
                          Bezier{o, Eigen::Vector2d(1e308, 0), {-1e308, 1e308}, {2, 0}}}) {
    EXPECT_EQ(fit_bezier_elastica(b).status, FitStatus::kUnsupported);
  }
}

TEST(FitLanes, EveryInstructionSetComputesTheSameBits) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> noise(0, 0.02);
  constexpr int kPoints = 17;
  const lanes::FitGrid grid{kPoints, 2, std::vector<double>(kPoints, 1.0 / kPoints)};
  std::vector<std::array<double, kPoints>> x(40), y(40);
  std::vector<lanes::FitData> data;
  std::vector<lanes::FitTask> tasks;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (int k = 0; k < kPoints; ++k) {
      const auto u = static_cast<std::size_t>(k);
      x[i][u] = (k - 8) / 16.0 + noise(random);
      y[i][u] = 0.2 * (x[i][u] * x[i][u] - 0.09) + noise(random);
    }
    data.push_back({x[i].data(), y[i].data(), nullptr, nullptr, 1e-6, 0, {}});
    tasks.push_back({i, {noise(random), 0, 0}, 0, 0, false});
  }
  auto baseline = tasks;
  lanes::solve(grid, data, baseline, Simd::kBaseline);
  for (const Simd simd : {Simd::kAvx2, Simd::kAvx512}) {
    if (!supported(simd)) GTEST_SKIP() << "this processor has no wider vectors to compare";
    auto wide = tasks;
    lanes::solve(grid, data, wide, simd);
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      EXPECT_EQ(wide[i].z, baseline[i].z);
      EXPECT_EQ(wide[i].iterations, baseline[i].iterations);
    }
  }
}

}  // namespace
}  // namespace hotblade::elastica
