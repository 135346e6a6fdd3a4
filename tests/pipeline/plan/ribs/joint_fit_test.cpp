#include "pipeline/plan/ribs/joint_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "elastica/curve/elastica.hpp"

namespace hotblade::pipeline {
namespace {

// Ribs of a shape that changes evenly along the sweep, each measured with an error of its own.
std::vector<RibFit> jittery_ribs(int n, double noise_mm) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, noise_mm);
  std::vector<RibFit> ribs;
  for (int i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / (n - 1);
    const elastica::Elastica shape{0, 10 * t, 0.3 + 0.1 * t, -0.002 - 0.0005 * t, 2e-6, 1e-6 * t, 300};
    RibFit rib;
    rib.bezier.fill(Eigen::Vector2d::Zero());
    rib.offset_mm = 25.0 * i;
    const double bow = normal(random), lift = normal(random), tilt = normal(random);
    for (const elastica::CurvePoint& p : sample(shape, kRibSamples)) {
      const double u = static_cast<double>(rib.target.size()) / (kRibSamples - 1);
      rib.target.emplace_back(p.x, p.y + lift + tilt * (u - 0.5) + bow * std::sin(3.14159265 * u));
    }
    const elastica::Elastica start[] = {shape};
    const elastica::ElasticaFit fit = fit_elastica(rib.target, start, {});
    rib.elastica = fit.elastica;
    rib.deviation_mm = fit.max;
    ribs.push_back(rib);
  }
  return ribs;
}

JointFitOptions options_with(double allowance_mm) {
  JointFitOptions options;
  options.blade_length_mm = 400;
  options.allowance_mm = allowance_mm;
  options.most_mm = 1;
  return options;
}

TEST(JointFit, CalmsTheClampsWithinTheAllowance) {
  const std::vector<RibFit> before = jittery_ribs(12, 0.05);
  std::vector<RibFit> after = before;
  const JointFitReport report = joint_fit(after, options_with(0.3));
  EXPECT_GT(report.weight, 0);
  EXPECT_LT(report.acceleration_after_mm_s2, 0.5 * report.acceleration_before_mm_s2);
  EXPECT_EQ(report.acceleration_before_mm_s2, clamp_acceleration_mm_s2(before, options_with(0.3)));
  EXPECT_EQ(report.acceleration_after_mm_s2, clamp_acceleration_mm_s2(after, options_with(0.3)));
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_LE(after[i].deviation_mm, before[i].deviation_mm + 0.3);
    EXPECT_NEAR(elastica::max_distance(after[i].target, after[i].elastica), after[i].deviation_mm, 1e-9);
  }
}

TEST(JointFit, LeavesTheRibsWhereNothingIsAllowed) {
  const std::vector<RibFit> before = jittery_ribs(8, 0.05);
  std::vector<RibFit> after = before;
  const JointFitReport report = joint_fit(after, options_with(0));
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_LE(after[i].deviation_mm, before[i].deviation_mm);
  EXPECT_LE(report.acceleration_after_mm_s2, report.acceleration_before_mm_s2);
}

TEST(JointFit, LeavesTwoRibsAsTheyAre) {
  std::vector<RibFit> ribs = jittery_ribs(2, 0.05);
  const elastica::Elastica was = ribs[0].elastica;
  const JointFitReport report = joint_fit(ribs, options_with(1));
  EXPECT_EQ(report.weight, 0);
  EXPECT_EQ(ribs[0].elastica.kappa, was.kappa);
}

TEST(JointFit, KeepsEndsThatAreSharedWithANeighbour) {
  std::vector<RibFit> ribs = jittery_ribs(9, 0.03);
  for (RibFit& rib : ribs) {
    const elastica::CurvePoint end = point_at(rib.elastica, rib.elastica.length);
    rib.clamp_end = elastica::PlanarPose{end.x, end.y, end.theta};
  }
  (void)joint_fit(ribs, options_with(0.3));
  for (const RibFit& rib : ribs) {
    const elastica::CurvePoint end = point_at(rib.elastica, rib.elastica.length);
    EXPECT_LT(std::hypot(end.x - rib.clamp_end->x, end.y - rib.clamp_end->y), 1e-6);
    EXPECT_LT(std::abs(std::remainder(end.theta - rib.clamp_end->theta, 2 * 3.14159265358979)), 1e-8);
  }
}

// A tip: the last rib is so short that its elastica may wind up at will on the way to the clamps.
TEST(JointFit, HasAnAnswerWhereAShortRibWindsUp) {
  std::vector<RibFit> ribs = jittery_ribs(6, 0.05);
  RibFit& tip = ribs.back();
  tip.target.clear();
  for (int i = 0; i < kRibSamples; ++i)
    tip.target.emplace_back(150 + 0.05 * i / (kRibSamples - 1), 30 + 0.01 * (i % 2));
  tip.elastica = {150, 30, 0.3, 0.002, 0, 1e3, 0.05};
  tip.deviation_mm = elastica::max_distance(tip.target, tip.elastica);
  ASSERT_THROW(elastica::ElasticaCurve({150, 30, 0.3, 0.002, 0, 1e7, 400}), std::logic_error);
  tip.elastica.lambda2 = 1e7;
  JointFitReport report;
  EXPECT_NO_THROW(report = joint_fit(ribs, options_with(0.3)));
  EXPECT_EQ(report.weight, 0);
}

TEST(ClampAcceleration, OfCirclesMovedAlongAParabolaIsItsSecondDerivative) {
  std::vector<RibFit> ribs;
  for (int i = 0; i < 6; ++i) {
    RibFit rib;
    rib.bezier.fill(Eigen::Vector2d::Zero());
    rib.offset_mm = i < 3 ? 10.0 * i : 15.0 * i - 10;  // uneven
    rib.elastica = {0, 0.002 * rib.offset_mm * rib.offset_mm, 0.2, -0.001, 0, 0, 300};
    ribs.push_back(rib);
  }
  JointFitOptions options = options_with(0);
  options.feed_mm_s = 10;
  EXPECT_NEAR(clamp_acceleration_mm_s2(ribs, options), 100 * 0.004, 1e-9);
}

}  // namespace
}  // namespace hotblade::pipeline
