#include "elastica/fit/fit_clamped.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "elastica/fit/fit_bezier.hpp"
#include "tests/elastica/fit/ribs.hpp"

namespace hotblade::elastica {
namespace {

ClampedEnds ends_of(const Elastica& e) {
  const CurvePoint p = ElasticaCurve(e).at(e.length);
  return {{e.x, e.y, e.theta}, PlanarPose{p.x, p.y, p.theta}};
}

double rms(const std::vector<Eigen::Vector2d>& q, const Elastica& e) {
  const auto p = positions(e, static_cast<int>(q.size()));
  double sum = 0;
  for (std::size_t i = 0; i < q.size(); ++i) sum += (p[i] - q[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(q.size()));
}

TEST(FitClamped, RecoversASegmentFromItsOwnSamplesAndEnds) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Elastica e = random_rib(random);
    const auto q = positions(e, 49);
    const ClampedFit fit = fit_clamped(q, ends_of(e), {}, kNoPull);
    EXPECT_EQ(fit.status, ClampedStatus::kOk) << trial;
    EXPECT_LT(fit.max, 1e-8 * e.length) << trial;
    ClampedEnds one = ends_of(e);
    one.end.reset();
    EXPECT_LT(fit_clamped(q, one, {}, kNoPull).max, 1e-8 * e.length) << trial;
  }
}

TEST(FitClamped, KeepsBothEndsOfDisturbedPoints) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int trial = 0; trial < 100; ++trial) {
    const Elastica e = random_rib(random);
    auto q = positions(e, 49);
    const double wave = 3 + 2 * u(random), size = 0.003 * e.length * u(random);
    for (std::size_t i = 0; i < q.size(); ++i) {
      q[i].y() += size * std::sin(wave * static_cast<double>(i) / 48.0);
    }
    ClampedEnds ends = ends_of(e);
    ends.start.theta += 0.02 * u(random);
    ends.end->theta += 0.02 * u(random);
    ends.end->x += 0.002 * e.length * u(random);
    const ClampedFit fit = fit_clamped(q, ends, {}, kNoPull);
    ASSERT_NE(fit.status, ClampedStatus::kNoCurve) << trial;
    EXPECT_LT(fit.end_miss, 1e-8 * e.length) << trial;
    EXPECT_LT(fit.angle_miss, 1e-8) << trial;
    EXPECT_DOUBLE_EQ(fit.elastica.x, ends.start.x);
    EXPECT_DOUBLE_EQ(fit.elastica.theta, ends.start.theta);
    EXPECT_LT(fit.rms, 0.02 * e.length) << trial;
    // Free ends can only come closer.
    EXPECT_LE(fit_elastica(q, {}, kNoPull).rms, fit.rms * (1 + 1e-9)) << trial;
  }
}

TEST(FitClamped, IsTheNearestOfItsFamily) {
  // Neighbours on the family: the same ends, pulled away from the points by a prior of another tension.
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Elastica e = random_rib(random);
    auto q = positions(e, 49);
    for (std::size_t i = 0; i < q.size(); ++i) q[i].x() += 1.5 * std::sin(0.2 * static_cast<double>(i));
    const ClampedFit fit = fit_clamped(q, ends_of(e), {}, kNoPull);
    for (const double off : {-2.0, 2.0}) {
      MidState prior = mid_state(fit.elastica);
      prior.tension1 += off / (prior.length * prior.length);
      const ClampedFit moved = fit_clamped(q, ends_of(e), {}, {0, &prior, 1e-2});
      ASSERT_EQ(moved.status, ClampedStatus::kOk);
      EXPECT_GE(rms(q, moved.elastica), rms(q, fit.elastica) * (1 - 1e-9));
    }
  }
}

TEST(FitClamped, KeepsEndPointsAndTangentsOfBeziers) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  int kept = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const double a = u(random), c = u(random);
    const Bezier b{Eigen::Vector2d(0, 0),
                   {0.4 * std::cos(a), 0.4 * std::sin(a)},
                   {1 - 0.4 * std::cos(c), -0.4 * std::sin(c)},
                   {1, 0}};
    const ClampedFit fit = fit_clamped(b);
    if (fit.status == ClampedStatus::kNoCurve) continue;
    ++kept;
    const ElasticaCurve curve(fit.elastica);
    EXPECT_LT((curve.at(fit.elastica.length).position() - b[3]).norm(), 1e-9);
    EXPECT_NEAR(std::remainder(curve.at(fit.elastica.length).theta - c, 6.283185307179586), 0, 1e-9);
    EXPECT_GE(fit.rms, 0.99 * fit_bezier_elastica(b).l2);
    EXPECT_LT(fit.rms, 0.05);
  }
  EXPECT_GE(kept, 58);
}

TEST(FitClamped, SaysSoWhenNoCurveReachesTheEnd) {
  // Twenty turns asked of an almost straight rib.
  const Elastica e{0, 0, 0, 1e-4, 0, 0, 800};
  ClampedEnds ends = ends_of(e);
  ends.end->theta += 125.66;
  EXPECT_EQ(fit_clamped(positions(e, 33), ends, {}, {}).status, ClampedStatus::kNoCurve);
  const Eigen::Vector2d o(0, 0);
  EXPECT_EQ(fit_clamped(Bezier{o, o, Eigen::Vector2d(1, 0), {2, 0}}).status, ClampedStatus::kNoCurve);
}

TEST(TrueTurning, CountsTurns) {
  const Elastica spiral{0, 0, 0.3, 1, 0, 0, 15};
  const auto q = positions(spiral, 200);
  EXPECT_NEAR(true_turning(q, 0.3, std::remainder(15.3, 6.283185307179586)), 15, 1e-9);
}

}  // namespace
}  // namespace hotblade::elastica
