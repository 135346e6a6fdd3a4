#include "pipeline/plan/motion/time_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

Eigen::Vector3d line(double u) {
  return {300 * u, 0, 0};
}
Eigen::Vector3d wave(double u) {
  return {300 * u, 20 * std::sin(12 * u), 0};
}

TEST(FastestTimeLaw, TakesTheTrapezoidsTimeOnALine) {
  MotionSettings limits;
  const TimeLaw law = fastest_time_law(path(600, line, false), limits);
  // Shares of the limits that the law leaves for sampling: 98% of the speed, 30% of the acceleration.
  const double v = 0.98 * limits.travel_mm_s, a = 0.3 * limits.accel_mm_s2;
  EXPECT_NEAR(law.duration_s, 300 / v + v / a, 0.02);
  EXPECT_EQ(law.sigma.front(), 0);
  EXPECT_EQ(law.sigma.back(), 1);
  EXPECT_LE(law.step_s, limits.waypoint_s);
}

TEST(FastestTimeLaw, HoldsTheFeedAtTheFastestPointInFoam) {
  MotionSettings limits;
  const TimeLaw law = fastest_time_law(path(600, line, true), limits);
  double fastest = 0;
  for (std::size_t i = 1; i < law.sigma.size(); ++i) {
    fastest = std::max(fastest, 600 * (law.sigma[i] - law.sigma[i - 1]) / law.step_s);
  }
  EXPECT_LE(fastest, limits.feed_mm_s * (1 + 1e-9));
  EXPECT_GT(fastest, 0.999 * limits.feed_mm_s);
}

TEST(FastestTimeLaw, WaypointsKeepSpeedAndAccelerationOnACurvedPath) {
  MotionSettings limits;
  const TimeLaw law = fastest_time_law(path(1000, wave, false), limits);
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  double speed = 0, accel = 0;
  for (std::size_t i = 1; i <= law.sigma.size(); ++i) {
    const double to = law.sigma[std::min(i, law.sigma.size() - 1)];
    const Eigen::Vector3d v1 = (wave(to) - wave(law.sigma[i - 1])) / law.step_s;
    speed = std::max(speed, v1.norm());
    accel = std::max(accel, (v1 - v).norm() / law.step_s);
    v = v1;
  }
  EXPECT_LE(speed, limits.travel_mm_s);
  EXPECT_LE(accel, limits.accel_mm_s2);
  EXPECT_GT(accel, 0.2 * limits.accel_mm_s2);
}

TEST(FastestTimeLaw, OfAPathThatStandsStillTakesNoTime) {
  const TimeLaw law = fastest_time_law(path(
                                           10, [](double) { return Eigen::Vector3d(1, 2, 3); }, false),
                                       {});
  EXPECT_EQ(law.duration_s, 0);
}

}  // namespace
}  // namespace hotblade::pipeline
