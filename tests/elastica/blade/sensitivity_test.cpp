#include "elastica/blade/sensitivity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "elastica/blade/stability.hpp"
#include "elastica/fit/fit.hpp"

namespace hotblade::elastica {
namespace {

const Elastica kBlade{30, -20, 0.7, -1.5e-3, 2e-5, 4e-6, 800};

PlanarPose nudged(const PlanarPose& p, std::size_t coordinate, double by) {
  const double c = std::cos(p.theta), s = std::sin(p.theta);
  if (coordinate == 0) return {p.x + by * c, p.y + by * s, p.theta};
  if (coordinate == 1) return {p.x - by * s, p.y + by * c, p.theta};
  return {p.x, p.y, p.theta + by};
}

TEST(Sensitivity, AgreesWithBladesSolvedBetweenErringClamps) {
  ASSERT_GT(stability_margin(kBlade), 5);
  const Sensitivity s = sensitivity(kBlade);
  for (std::size_t i = 0; i < 6; ++i) {
    ClampPair clamps = clamps_of(kBlade);
    const double by = i % 3 == 2 ? 1e-3 : 0.1;
    (i < 3 ? clamps.a : clamps.b) = nudged(i < 3 ? clamps.a : clamps.b, i % 3, by);
    const auto shape = solve_clamped(kBlade, clamps);
    ASSERT_TRUE(shape);
    double largest = 0;
    const auto p = sample(kBlade, 401), q = sample(shape->elastica, 401);
    for (std::size_t j = 0; j < p.size(); ++j)
      largest = std::max(largest, (p[j].position() - q[j].position()).norm());
    // First order, and the largest of some twenty places: within two percent.
    EXPECT_NEAR(s.displacement_mm[i], largest, 0.02 * largest) << i;
  }
}

// The farthest that a point of the second blade between two shares of its length is from the first.
double apart_mm(const Elastica& blade, const Elastica& other, double from, double to) {
  std::vector<Eigen::Vector2d> points;
  for (const CurvePoint& p : sample(segment(other, from * other.length, to * other.length), 201))
    points.push_back(p.position());
  return max_distance(points, blade);
}

TEST(Sensitivity, TotalIsTheWorstOfAllSignsOfTheErrors) {
  const double from = 0.25, to = 0.7;
  const SensitivityOptions part{0.1, 2e-4, from * kBlade.length, to * kBlade.length}, whole{0.1, 2e-4};
  double of_part = 0, of_whole = 0;
  for (unsigned signs = 0; signs < 64; ++signs) {
    ClampPair clamps = clamps_of(kBlade);
    for (std::size_t i = 0; i < 6; ++i) {
      const double by = (signs >> i & 1 ? 1 : -1) * (i % 3 == 2 ? 2e-4 : 0.1);
      (i < 3 ? clamps.a : clamps.b) = nudged(i < 3 ? clamps.a : clamps.b, i % 3, by);
    }
    const auto shape = solve_clamped(kBlade, clamps);
    ASSERT_TRUE(shape);
    of_part = std::max(of_part, apart_mm(kBlade, shape->elastica, from, to));
    // A blade that is moved along itself sticks out at an end.
    of_whole = std::max(of_whole, apart_mm(kBlade, shape->elastica, 0.002, 0.998));
  }
  // First order, at some sixty places, of a part that ends between two of them.
  EXPECT_NEAR(sensitivity(kBlade, part).total_mm, of_part, 0.02 * of_part);
  EXPECT_NEAR(sensitivity(kBlade, whole).total_mm, of_whole, 0.02 * of_whole);
  const Sensitivity s = sensitivity(kBlade, whole);
  EXPECT_LT(s.total_mm, 0.8 * std::accumulate(s.displacement_mm.begin(), s.displacement_mm.end(), 0.0));
}

TEST(Sensitivity, GrowsWithTheErrorAndDoesNotDependOnThePlace) {
  const Sensitivity s = sensitivity(kBlade), twice = sensitivity(kBlade, {0.2, 2e-3});
  Elastica moved = kBlade;
  moved.x += 500, moved.theta += 1.1;
  const double c = std::cos(1.1), si = std::sin(1.1);
  moved.lambda1 = c * kBlade.lambda1 - si * kBlade.lambda2;
  moved.lambda2 = si * kBlade.lambda1 + c * kBlade.lambda2;
  const Sensitivity other = sensitivity(moved);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(twice.displacement_mm[i], 2 * s.displacement_mm[i], 1e-9);
    EXPECT_NEAR(other.displacement_mm[i], s.displacement_mm[i], 1e-6);
  }
}

TEST(Sensitivity, OfANearlyStraightBladeGrowsWithTheRootOfTheErrorAlongIt) {
  // Between aligned clamps, pushed together by 0.1 mm each: solved, against the closed form.
  const double length = 800, slack = 0.5, more = 0.2;
  const auto bow = [&](double s) {
    const double turn = 2 * std::sqrt(s / length);
    const Elastica near{0, 0, 0, turn * 2 * M_PI / length, 4 * M_PI * M_PI / length / length, 0, length};
    const auto shape = solve_clamped(near, {{0, 0, 0}, {length - s, 0, 0}});
    EXPECT_TRUE(shape && shape->stable());
    return std::abs(point_at(shape->elastica, 0.5 * length).y);
  };
  EXPECT_NEAR(straight_bow(length, slack), bow(slack), 1e-3 * bow(slack));
  const SensitivityOptions along{0.5 * more, 0};
  // The clamps' own 0.1 mm across is added; pulling moves it more than pushing.
  EXPECT_NEAR(straight_response_mm(length, slack, true, along) - 0.1, bow(slack) - bow(slack - more), 0.02);
  EXPECT_NEAR(straight_response_mm(length, slack, false, along) - 0.1, bow(slack + more) + bow(slack), 0.02);
  EXPECT_EQ(straight_bow(length, -1), 0);
}

}  // namespace
}  // namespace hotblade::elastica
