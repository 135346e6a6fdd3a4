#include "pipeline/plan/ribs/bridge.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "pipeline/plan/plan.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;
using Points = std::vector<Vector2d>;
using Curve = std::function<Vector2d(double)>;

Points along(const Curve& curve, double from, double to, int count) {
  Points points;
  for (int i = 0; i <= count; ++i) points.push_back(curve(from + (to - from) * i / count));
  return points;
}

constexpr double kRadius = 1000;

Vector2d circle(double angle) {
  return {kRadius * std::sin(angle), kRadius * std::cos(angle)};
}

double off_circle(const Points& points) {
  double worst = 0;
  for (const Vector2d& q : points) worst = std::max(worst, std::abs(q.norm() - kRadius));
  return worst;
}

TEST(FillGap, FollowsACircle) {
  const double bound[] = {3e-7, 2e-5, 2e-4};
  for (int i = 0; i < 3; ++i) {
    const double half = 0.1 * (i + 1);
    const auto fill = fill_gap(along(circle, -0.94, -half, 2000), along(circle, half, 0.94, 2000));
    ASSERT_TRUE(fill);
    EXPECT_EQ(fill->size(), 63u);
    EXPECT_LT(off_circle(*fill), bound[i] * kRadius) << half;
  }
}

// Facets of 40 mm on that circle are 0.2 mm off it, and the tangents of single edges by 0.02 rad, which alone
// would move the middle of a gap of 600 mm by 3 mm.
TEST(FillGap, HardlyShowsTheFacetsOfAMesh) {
  for (const double shift : {0.0, 0.007, 0.02, 0.033}) {
    Points before = along(circle, -0.94 + shift, -0.3 + shift, 16);
    before.back() = 0.5 * (before[before.size() - 2] + before.back());
    const auto fill = fill_gap(before, along(circle, 0.3, 0.94, 16));
    ASSERT_TRUE(fill);
    EXPECT_LT(off_circle(*fill), 0.4) << shift;
  }
}

TEST(FillGap, IsGuidedByTheLongerSideWhereTheOtherIsASliver) {
  const auto fill = fill_gap(along(circle, -0.31, -0.3, 40), along(circle, 0.3, 0.94, 2000));
  ASSERT_TRUE(fill);
  EXPECT_LT(off_circle(*fill), 0.2);
}

TEST(FillGap, TurnsAndGrowsWithThePieces) {
  const double turn = 0.7, size = 3.7;
  const auto placed = [&](Points points) {
    for (Vector2d& q : points) q = size * (Eigen::Rotation2Dd(turn) * q) + Vector2d(5000, -300);
    return points;
  };
  const Points before = along(circle, -0.6, -0.2, 40), after = along(circle, 0.15, 0.7, 37);
  const auto fill = fill_gap(before, after), there = fill_gap(placed(before), placed(after));
  ASSERT_TRUE(fill && there);
  const Points moved = placed(*fill);
  for (std::size_t i = 0; i < moved.size(); ++i) EXPECT_LT((moved[i] - (*there)[i]).norm(), 1e-8);
}

TEST(FillGap, PiecesThatTurnBackAreNotJoined) {
  const Points before{{0, 0}, {100, 0}}, back{{150, 0}, {150, 100}, {140, 100}}, on{{150, 0}, {250, 10}};
  EXPECT_FALSE(fill_gap(before, back));
  EXPECT_TRUE(fill_gap(before, on));
}

// A panel on a cylinder of 900 mm with a window of 240 x 200 mm: its middle is 8 mm above the window's chord.
TEST(BridgePlan, OneStripSpansAWindowWithinTheTolerance) {
  const auto panel = [](double s, double t) -> Eigen::Vector3d {
    const double angle = 0.7 * (s - 0.5);
    return {900 * std::sin(angle), 500 * t, 900 * std::cos(angle) - 800};
  };
  const auto window = [](int i, int j) { return !(20 <= i && i < 43 && 12 <= j && j < 28); };
  Settings settings = along_x();
  settings.slice.direction = {{0, 1, 0}};
  const PlanResult whole = plan(grid_design("panel", 64, 40, panel, window), settings, {});
  EXPECT_EQ(whole.program.verification.status, VerificationStatus::kPassed);
  ASSERT_EQ(whole.program.strips.size(), 1u);
  EXPECT_LT(whole.verification.deviation.max, 0.5);
  EXPECT_EQ(whole.verification.uncut_mm2, 0);
  // The cut over the window, 240 x 200 mm without 3 mm along its border, at 2.5 mm.
  const auto beyond = static_cast<double>(whole.verification.beyond_samples);
  EXPECT_NEAR(beyond, 234 * 194 / (2.5 * 2.5), 0.25 * beyond);
}

}  // namespace
}  // namespace hotblade::pipeline
