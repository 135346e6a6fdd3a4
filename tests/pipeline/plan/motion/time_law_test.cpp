#include "pipeline/plan/motion/time_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace hotblade::pipeline {
namespace {

// Both clamps on the same curve; blade points in foam at a distance from it.
std::vector<PathSample> path(int n, const std::function<Eigen::Vector3d(double)>& p, bool foam) {
  std::vector<PathSample> samples;
  for (int i = 0; i <= n; ++i) {
    PathSample s;
    s.a.p = s.b.p = p(static_cast<double>(i) / n);
    if (foam) s.in_foam.push_back(2 * s.a.p);
    samples.push_back(s);
  }
  return samples;
}

Eigen::Vector3d straight_line(double u) {
  return {300 * u, 0, 0};
}
Eigen::Vector3d waved_line(double u) {
  return {300 * u, 20 * std::sin(12 * u), 0};
}

TimeLaw law_of(const std::vector<PathSample>& samples, const MotionSettings& limits) {
  return fastest_time_law(samples, limits, first_shares(samples));
}

TEST(FastestTimeLaw, TakesTheTrapezoidsTimeOnALine) {
  MotionSettings limits;
  const TimeLaw law = law_of(path(600, straight_line, false), limits);
  // Shares of the limits that the law uses in air: 98% of the speed, 60% of the acceleration.
  const double v = 0.98 * limits.travel_mm_s, a = 0.6 * limits.accel_mm_s2;
  EXPECT_NEAR(law.duration_s, 300 / v + v / a, 0.02);
  EXPECT_EQ(law.sigma.front(), 0);
  EXPECT_EQ(law.sigma.back(), 1);
  EXPECT_LE(law.step_s, limits.waypoint_s);
}

TEST(FastestTimeLaw, HoldsTheFeedAtTheFastestPointInFoam) {
  MotionSettings limits;
  const TimeLaw law = law_of(path(600, straight_line, true), limits);
  double fastest = 0;
  for (std::size_t i = 1; i < law.sigma.size(); ++i) {
    fastest = std::max(fastest, 600 * (law.sigma[i] - law.sigma[i - 1]) / law.step_s);
  }
  EXPECT_LE(fastest, limits.feed_mm_s * (1 + 1e-9));
  EXPECT_GT(fastest, 0.999 * limits.feed_mm_s);
}

TEST(FastestTimeLaw, WaypointsKeepSpeedAndAccelerationOnACurvedPath) {
  MotionSettings limits;
  const TimeLaw law = law_of(path(1000, waved_line, false), limits);
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  double speed = 0, accel = 0;
  for (std::size_t i = 1; i <= law.sigma.size(); ++i) {
    const double to = law.sigma[std::min(i, law.sigma.size() - 1)];
    const Eigen::Vector3d v1 = (waved_line(to) - waved_line(law.sigma[i - 1])) / law.step_s;
    speed = std::max(speed, v1.norm());
    accel = std::max(accel, (v1 - v).norm() / law.step_s);
    v = v1;
  }
  EXPECT_LE(speed, limits.travel_mm_s);
  EXPECT_LE(accel, limits.accel_mm_s2);
  EXPECT_GT(accel, 0.2 * limits.accel_mm_s2);
}

TEST(FastestTimeLaw, OfAPathThatStandsStillTakesNoTime) {
  const TimeLaw law = law_of(path(
                                 10, [](double) { return Eigen::Vector3d(1, 2, 3); }, false),
                             {});
  EXPECT_EQ(law.duration_s, 0);
}

TEST(FastestTimeLaw, RunsACircleAtTheRateItsBendAllows) {
  MotionSettings limits;
  limits.travel_mm_s = 1000;
  const double radius = 20, turns = 20;
  const TimeLaw law = law_of(path(
                                 4000,
                                 [&](double u) {
                                   const double phi = 2 * M_PI * turns * u;
                                   return Eigen::Vector3d(radius * std::cos(phi), radius * std::sin(phi), 0);
                                 },
                                 false),
                             limits);
  const double v = std::sqrt(0.6 * limits.accel_mm_s2 * radius), length = 2 * M_PI * turns * radius;
  EXPECT_GT(law.duration_s, length / v);
  EXPECT_LT(law.duration_s, length / v + v / (0.6 * limits.accel_mm_s2) * 2);
}

// A right angle, rounded by a millimetre, in the middle of two straight lines.
Eigen::Vector3d corner(double u) {
  const double s = 300 * (u - 0.5), bend = 0.5 * M_PI, r = 1;
  if (s < 0) return {s, 0, 0};
  if (s < r * bend) return {r * std::sin(s / r), r * (1 - std::cos(s / r)), 0};
  return {r, r + s - r * bend, 0};
}

TEST(FastestTimeLaw, SlowsAtACornerAndNotOnTheWayToIt) {
  const MotionSettings limits;
  const TimeLaw law = law_of(path(6000, corner, false), limits);
  const double v = 0.98 * limits.travel_mm_s, a = 0.6 * limits.accel_mm_s2;
  // From rest and to rest, and down to a stop and up again at the worst.
  EXPECT_GT(law.duration_s, 300 / v + v / a);
  EXPECT_LT(law.duration_s, 300 / v + 2 * v / a);
}

TEST(FastestTimeLaw, StepsAreWholeMicrosecondsThatAControllerTakes) {
  for (const double waypoint_s : {0.05, 0.0333333, 0.00777, 0.005}) {
    MotionSettings limits;
    limits.waypoint_s = waypoint_s;
    for (const double travel : {1.0, 9.9, 100.0}) {
      limits.travel_mm_s = travel;
      const TimeLaw law = law_of(path(300, waved_line, false), limits);
      EXPECT_GE(law.step_s, 0.005 - 1e-12);
      EXPECT_LE(law.step_s, waypoint_s + 1e-9);
      EXPECT_NEAR(law.step_s * 1e6, std::round(law.step_s * 1e6), 1e-6);
      EXPECT_NEAR(law.duration_s, law.step_s * static_cast<double>(law.sigma.size() - 1), 1e-9);
    }
  }
}

TEST(FastestTimeLaw, GivesAPathThatHardlyMovesTheShortestStep) {
  const TimeLaw law = law_of(path(
                                 10, [](double u) { return Eigen::Vector3d(1e-9 * u, 0, 0); }, false),
                             {});
  EXPECT_EQ(law.sigma.size(), 2U);
  EXPECT_EQ(law.duration_s, 0.005);
}

TEST(FastestTimeLaw, SlowsByTheSharesGivenAndOnlyWhereTheyAre) {
  const MotionSettings limits;
  const auto samples = path(1000, straight_line, false);
  LawShares shares = first_shares(samples);
  for (std::size_t i = 450; i <= 550; ++i) shares.rate2[i] *= 0.25;
  const TimeLaw slowed = fastest_time_law(samples, limits, shares), usual = law_of(samples, limits);
  // 30 mm at half the rate, and the way down to it and up again.
  const double v = 0.98 * limits.travel_mm_s, a = 0.6 * limits.accel_mm_s2;
  EXPECT_NEAR(slowed.duration_s - usual.duration_s, 30 / v + 2 * (v / 2) * (v / 2) / (2 * a * v), 0.03);
  LawShares few = shares;
  few.accel[kTurnB].pop_back();
  EXPECT_THROW((void)fastest_time_law(samples, limits, few), std::logic_error);
}

}  // namespace
}  // namespace hotblade::pipeline
