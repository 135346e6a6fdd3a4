#include "elastica/sensitivity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "elastica/stability.hpp"

namespace hotblade::elastica {
namespace {

const Elastica kBlade{30, -20, 0.7, -1.5e-3, 2e-5, 4e-6, 800};

ClampPose nudged(const ClampPose& p, std::size_t coordinate, double by) {
  const double c = std::cos(p.theta), s = std::sin(p.theta);
  if (coordinate == 0) return {p.x + by * c, p.y + by * s, p.theta};
  if (coordinate == 1) return {p.x - by * s, p.y + by * c, p.theta};
  return {p.x, p.y, p.theta + by};
}

TEST(Sensitivity, AgreesWithBladesSolvedBetweenErringClamps) {
  ASSERT_GT(stability_margin(kBlade), 5);
  const Sensitivity s = sensitivity(kBlade);
  double total = 0;
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
    total += s.displacement_mm[i];
  }
  EXPECT_DOUBLE_EQ(s.total_mm, total);
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

// Smallest error that loses the shape, over many directions: an upper bound too, but from a dense search.
double dense_margin_mm(const Elastica& e, double largest, int directions) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  double least = largest;
  for (int i = 0; i < directions; ++i) {
    Eigen::Vector3d d(normal(random), normal(random), normal(random));
    d *= least / d.norm();
    ClampPair to = clamps_of(e);
    to.b.x += d[0], to.b.y += d[1], to.b.theta += d[2] / (0.5 * e.length);
    FollowOptions walk;
    walk.smallest_step = 2e-3;
    const FollowReport way = follow(e, to, walk);
    if (way.status == FollowStatus::kSnapped) least *= way.fraction;
  }
  return least;
}

TEST(ClampMargin, IsCloseToTheSmallestOfManyRandomErrors) {
  // Arches turned over towards their snap: at 0.6, 0.8 and 0.95 of the way.
  const Elastica arc{0, 0, 0.6, -1.2 / 800, 0, 0, 800};
  const FollowReport up = follow(arc, {{0, 0, 0.6}, {740, 0, -0.6}});
  const ClampPair over{{0, 0, -0.6}, {740, 0, 0.6}};
  const FollowReport lost = follow(up.shape.elastica, over);
  ASSERT_EQ(lost.status, FollowStatus::kSnapped);
  double last = 1e9;
  for (const double share : {0.6, 0.8, 0.95}) {
    const double t = share * lost.fraction;
    const FollowReport at = follow(up.shape.elastica, {{0, 0, 0.6 - 1.2 * t}, {740, 0, -0.6 + 1.2 * t}});
    ASSERT_EQ(at.status, FollowStatus::kFollowed);
    const ClampMargin margin = clamp_margin(at.shape.elastica, {200, 0});
    const double dense = dense_margin_mm(at.shape.elastica, 200, 150);
    EXPECT_LT(margin.margin_mm, 1.1 * dense) << share;
    EXPECT_GT(margin.margin_mm, 0.5 * dense) << share;
    EXPECT_LT(margin.margin_mm, last);
    last = margin.margin_mm;
    if (share < 0.8) continue;  // beyond 200 mm
    // The error that it names does lose the shape, and a little less does not.
    ClampPair to = clamps_of(at.shape.elastica);
    const double c = std::cos(to.a.theta), s = std::sin(to.a.theta);
    const auto erring = [&](double scale) {
      return ClampPair{to.a,
                       {to.b.x + scale * (c * margin.error[0] - s * margin.error[1]),
                        to.b.y + scale * (s * margin.error[0] + c * margin.error[1]),
                        to.b.theta + scale * margin.error[2]}};
    };
    EXPECT_EQ(follow(at.shape.elastica, erring(1.02)).status, FollowStatus::kSnapped);
    EXPECT_EQ(follow(at.shape.elastica, erring(0.98)).status, FollowStatus::kFollowed);
  }
}

TEST(ClampMargin, IsNoneForAnUnstableShapeAndTheLimitForARelaxedOne) {
  EXPECT_EQ(clamp_margin({0, 0, 0.3, -20, 400, 0, 1}).margin_mm, 0);
  EXPECT_EQ(clamp_margin({0, 0, 0.3, -0.6 / 800, 0, 0, 800}, {2, 0}).margin_mm, 2);
}

TEST(ClampMargin, RefusesNonsense) {
  EXPECT_THROW((void)clamp_margin(kBlade, {0, 0}), std::logic_error);
  EXPECT_THROW((void)clamp_margin(kBlade, {1, NAN}), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
