#include "elastica/bezier/residual_batch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "elastica/bezier/standard_position.hpp"

namespace hotblade::elastica {
namespace {

struct Results {
  std::vector<double> e;
  std::vector<ResidualStatus> status;
  explicit Results(std::size_t n) : e(n, -1), status(n, ResidualStatus::kNotFinite) {}
  ResidualBatch out() { return {e, status}; }
};

struct Curves {
  std::array<std::vector<double>, 8> c;
  void add(const Bezier& b) {
    for (std::size_t i = 0; i < 4; ++i) {
      c[2 * i].push_back(b[i].x());
      c[2 * i + 1].push_back(b[i].y());
    }
  }
  [[nodiscard]] std::size_t size() const { return c[0].size(); }
  [[nodiscard]] BezierBatch part(std::size_t from, std::size_t n) const {
    const auto s = [&](std::size_t k) { return std::span<const double>(c[k]).subspan(from, n); };
    return {s(0), s(1), s(2), s(3), s(4), s(5), s(6), s(7)};
  }
  [[nodiscard]] Results run(Simd simd) const {
    Results r(size());
    lambda_residuals(part(0, size()), r.out(), simd);
    return r;
  }
};

struct Edges {
  std::vector<double> a1, a2, l1, l2;
  void add(const StandardPosition& s) {
    a1.push_back(s.a1);
    a2.push_back(s.a2);
    l1.push_back(s.l1);
    l2.push_back(s.l2);
  }
  [[nodiscard]] EdgeBatch batch() const { return {a1, a2, l1, l2}; }
};

std::vector<Bezier> random_beziers(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Bezier> curves;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d at(500 * u(random), 500 * u(random));
    const double scale = std::pow(10, 4 * u(random));
    Bezier b;
    for (auto& p : b) p = at + scale * Eigen::Vector2d(u(random), u(random));
    curves.push_back(b);
  }
  return curves;
}

std::vector<StandardPosition> random_edges(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi), length(0.05, 2);
  std::vector<StandardPosition> edges;
  for (int i = 0; i < count; ++i)
    edges.push_back({angle(random), angle(random), length(random), length(random)});
  return edges;
}

class EverySimd : public testing::TestWithParam<Simd> {
  void SetUp() override {
    if (!supported(GetParam())) GTEST_SKIP() << "this machine lacks the instruction set";
  }
};
INSTANTIATE_TEST_SUITE_P(ResidualBatch, EverySimd,
                         testing::Values(Simd::kBaseline, Simd::kAvx2, Simd::kAvx512));

// Rounding of coordinates far from the origin moves e itself; hence a share of what the frame can carry.
TEST_P(EverySimd, AgreesWithTheOrthogonalisedScalarResidual) {
  Curves curves;
  const auto beziers = random_beziers(5000, 1);
  for (const Bezier& b : beziers) curves.add(b);
  const Results r = curves.run(GetParam());
  for (std::size_t i = 0; i < beziers.size(); ++i) {
    const LambdaResidual scalar = lambda_residual(beziers[i]);
    ASSERT_EQ(r.status[i], scalar.status);
    ASSERT_NEAR(r.e[i], scalar.value, 1e-9) << i;
  }
}

TEST_P(EverySimd, OfNearlyStraightCurvesAgreesWithTheScalarResidual) {
  Curves curves;
  std::vector<Bezier> beziers;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const double flat = std::pow(10, -1 - 0.02 * i), turn = std::numbers::pi * u(random);
    const Eigen::Vector2d along(std::cos(turn), std::sin(turn)), across(-along.y(), along.x());
    const double a = flat * u(random), b = flat * u(random);
    beziers.push_back({Eigen::Vector2d(0, 0), along / 3 + a * across, along * 0.6 + b * across, along});
    curves.add(beziers.back());
  }
  const Results r = curves.run(GetParam());
  for (std::size_t i = 0; i < beziers.size(); ++i) {
    const double flat = std::pow(10, -1 - 0.02 * static_cast<double>(i));
    // The coordinates' rounding, 1e-16, is that share of the flatness that carries the curvature.
    EXPECT_NEAR(r.e[i], lambda_residual(beziers[i]).value, 1e-9 + 1e-14 / flat) << i;
  }
}

// Circular arcs' Beziers: e is small, and differences of moments would leave 1e-8.
TEST_P(EverySimd, KeepsItsDigitsWhereTheResidualIsSmall) {
  Curves curves;
  std::vector<Bezier> beziers;
  for (int i = 1; i <= 64; ++i) {
    const double a = 0.01 * i, h = 4.0 / 3 * std::tan(a / 4);
    beziers.push_back({Eigen::Vector2d(1, 0),
                       {1, h},
                       {std::cos(a) + h * std::sin(a), std::sin(a) - h * std::cos(a)},
                       {std::cos(a), std::sin(a)}});
    curves.add(beziers.back());
  }
  const Results r = curves.run(GetParam());
  for (std::size_t i = 0; i < beziers.size(); ++i) {
    EXPECT_NEAR(r.e[i], lambda_residual(beziers[i]).value, 2e-12) << i;
  }
}

TEST_P(EverySimd, GivesTheSameBytesHoweverTheBatchIsSplit) {
  Curves curves;
  for (const Bezier& b : random_beziers(101, 3)) curves.add(b);
  const Results whole = curves.run(GetParam());
  for (const std::size_t step : {1U, 3U, 8U, 13U}) {
    Results parts(curves.size());
    for (std::size_t i = 0; i < curves.size(); i += step) {
      const std::size_t n = std::min(step, curves.size() - i);
      lambda_residuals(curves.part(i, n),
                       {std::span(parts.e).subspan(i, n), std::span(parts.status).subspan(i, n)}, GetParam());
    }
    EXPECT_EQ(std::memcmp(parts.e.data(), whole.e.data(), whole.e.size() * sizeof(double)), 0);
    EXPECT_EQ(parts.status, whole.status);
  }
}

TEST_P(EverySimd, GivesTheSameBytesOfRowsAsOfColumns) {
  std::vector<Bezier> beziers = random_beziers(1000, 3);
  beziers[17].fill(Eigen::Vector2d(1, 2));                                   // a cusp
  beziers[30][2].x() = std::numeric_limits<double>::infinity();              // not finite
  for (int k = 0; k < 4; ++k) beziers[31][k] = Eigen::Vector2d(k, 2.0 * k);  // straight
  for (const std::size_t n : {0, 1, 2, 3, 5, 7, 8, 9, 31, 32, 33, 1000}) {
    Curves curves;
    std::vector<double> rows;
    for (std::size_t i = 0; i < n; ++i) {
      curves.add(beziers[i]);
      for (const auto& p : beziers[i]) rows.insert(rows.end(), {p.x(), p.y()});
    }
    Results of_columns(n), of_rows(n);
    std::vector<double> bounds(n, -1), bounds_of_rows(n, -1);
    lambda_residuals(curves.part(0, n), {of_columns.e, of_columns.status, bounds}, GetParam());
    lambda_residuals(BezierRows{rows}, {of_rows.e, of_rows.status, bounds_of_rows}, GetParam());
    const std::size_t bytes = n * sizeof(double);
    EXPECT_EQ(std::memcmp(of_rows.e.data(), of_columns.e.data(), bytes), 0) << n;
    EXPECT_EQ(std::memcmp(bounds_of_rows.data(), bounds.data(), bytes), 0) << n;
    EXPECT_EQ(of_rows.status, of_columns.status) << n;
  }
}

TEST_P(EverySimd, GivesDegenerateCurvesTheScalarsStatus) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  using Point = Eigen::Vector2d;
  const std::vector<std::pair<Bezier, ResidualStatus>> cases{
      {{Point(0, 0), {1, 1}, {2, 2}, {3, 3}}, ResidualStatus::kStraight},
      {{Point(0, 0), {0, 0}, {0.3, 0.7}, {0.3, 0.7}}, ResidualStatus::kStraight},
      {{Point(0.1, 0), {3.1, 1}, {-2.9, -1}, {0.1, 0}}, ResidualStatus::kStraight},
      {{Point(5, 2), {5, 2}, {5, 2}, {5, 2}}, ResidualStatus::kCusp},
      {{Point(1, 2), {1, 2}, {3, 5}, {4, 2}}, ResidualStatus::kCusp},
      {{Point(1, 2), {2, 4}, {4, 2}, {4, 2}}, ResidualStatus::kCusp},
      // (t - 1/2)^2 and (t - 1/2)^3 (1 + ...): a cusp in the middle.
      {{Point(0, 0), {1, 1}, {0, 1}, {1, 0}}, ResidualStatus::kCusp},
      {{Point(0, 0), {1, 0}, {nan, 1}, {3, 1}}, ResidualStatus::kNotFinite},
      {{Point(0, 0), {1, 0}, {2, 1}, {3, inf}}, ResidualStatus::kNotFinite},
      {{Point(0, nan), {1, 0}, {2, 1}, {3, 1}}, ResidualStatus::kNotFinite},
      {{Point(0, 0), {1e300, 0}, {2, 1e300}, {3, 1}}, ResidualStatus::kNotFinite},
      {{Point(0, 0), {1e-130, 0}, {2e-130, 1e-130}, {3e-130, 3e-130}}, ResidualStatus::kOk},
      {{Point(0, 0), {1e130, 0}, {2e130, 1e130}, {3e130, 3e130}}, ResidualStatus::kOk},
      {{Point(0, 0), {1, 0.2}, {2, 0.3}, {3, 0}}, ResidualStatus::kOk}};
  Curves curves;
  for (const auto& c : cases) curves.add(c.first);
  const Results r = curves.run(GetParam());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    EXPECT_EQ(r.status[i], cases[i].second) << i;
    EXPECT_EQ(lambda_residual(cases[i].first).status, cases[i].second) << i;
    if (r.status[i] != ResidualStatus::kOk) {
      EXPECT_EQ(r.e[i], 0) << i;
    }
    EXPECT_TRUE(r.e[i] >= 0 && r.e[i] <= 1) << i;
  }
}

TEST_P(EverySimd, OfEdgesIsThatOfTheirBezier) {
  Edges edges;
  const auto positions = random_edges(3000, 4);
  for (const StandardPosition& s : positions) edges.add(s);
  Results r(positions.size());
  lambda_residuals(edges.batch(), r.out(), GetParam());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const LambdaResidual scalar = lambda_residual(to_bezier(positions[i]));
    ASSERT_EQ(r.status[i], scalar.status);
    ASSERT_NEAR(r.e[i], scalar.value, 1e-9) << i;
  }
}

TEST_P(EverySimd, GradientsAreThoseOfCentralDifferences) {
  const auto positions = random_edges(400, 5);
  const double h = 1e-5;
  Edges edges, moved;
  for (const StandardPosition& s : positions) {
    edges.add(s);
    moved.add({s.a1, s.a2, s.l1 - h, s.l2});
    moved.add({s.a1, s.a2, s.l1 + h, s.l2});
    moved.add({s.a1, s.a2, s.l1, s.l2 - h});
    moved.add({s.a1, s.a2, s.l1, s.l2 + h});
  }
  const std::size_t n = positions.size();
  Results r(n), plain(n), at(4 * n);
  std::vector<double> by_l1(n), by_l2(n);
  lambda_residual_gradients(edges.batch(), r.out(), by_l1, by_l2, GetParam());
  lambda_residuals(edges.batch(), plain.out(), GetParam());
  lambda_residuals(moved.batch(), at.out(), GetParam());
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_EQ(r.status[i], plain.status[i]);
    ASSERT_NEAR(r.e[i], plain.e[i], 1e-14);
    // Second differences bound the error of the first; near a cusp inside they are large.
    const double* e = at.e.data() + 4 * i;
    const double bend = std::abs(e[0] + e[1] - 2 * r.e[i]) + std::abs(e[2] + e[3] - 2 * r.e[i]);
    const double tolerance = 1e-7 + bend / h;
    EXPECT_NEAR(by_l1[i], (e[1] - e[0]) / (2 * h), tolerance) << i;
    EXPECT_NEAR(by_l2[i], (e[3] - e[2]) / (2 * h), tolerance) << i;
    largest = std::max(largest, std::abs(by_l1[i]));
  }
  EXPECT_GT(largest, 0.1);
}

TEST_P(EverySimd, EdgesOfZeroLengthOrNotFiniteHaveAStatus) {
  Edges edges;
  const double nan = std::nan("");
  const std::vector<std::pair<StandardPosition, ResidualStatus>> cases{
      {{1, 2, 0, 0.5}, ResidualStatus::kCusp},        {{1, 2, 0.5, 0}, ResidualStatus::kCusp},
      {{0, 0, 0.3, -0.3}, ResidualStatus::kStraight}, {{nan, 2, 0.5, 0.5}, ResidualStatus::kNotFinite},
      {{1, 2, 0.5, nan}, ResidualStatus::kNotFinite}, {{1, 2, 1e200, 0.4}, ResidualStatus::kNotFinite},
      {{0.5, 2.5, 0.4, 0.4}, ResidualStatus::kOk}};
  for (const auto& c : cases) edges.add(c.first);
  Results r(cases.size());
  std::vector<double> by_l1(cases.size()), by_l2(cases.size());
  lambda_residual_gradients(edges.batch(), r.out(), by_l1, by_l2, GetParam());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    EXPECT_EQ(r.status[i], cases[i].second) << i;
    if (r.status[i] != ResidualStatus::kOk) {
      EXPECT_TRUE(r.e[i] == 0 && by_l1[i] == 0 && by_l2[i] == 0) << i;
    }
  }
}

TEST(ResidualBatch, InstructionSetsAgree) {
  Curves curves;
  for (const Bezier& b : random_beziers(5000, 6)) curves.add(b);
  const Results baseline = curves.run(Simd::kBaseline), best = curves.run(best_simd());
  for (std::size_t i = 0; i < curves.size(); ++i) ASSERT_NEAR(baseline.e[i], best.e[i], 1e-9) << i;
  EXPECT_EQ(baseline.status, best.status);
}

TEST(ResidualBatch, RefusesSpansOfDifferentSizes) {
  Curves curves;
  for (const Bezier& b : random_beziers(3, 6)) curves.add(b);
  Results r(2);
  EXPECT_THROW(lambda_residuals(curves.part(0, 3), r.out()), std::logic_error);
  const std::vector<double> rows(17);
  EXPECT_THROW(lambda_residuals(BezierRows{rows}, r.out()), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
