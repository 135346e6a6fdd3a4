#include "elastica/bezier/curve_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace hotblade::elastica {
namespace {

std::vector<Eigen::Vector2d> positions(const Elastica& e, int n) {
  std::vector<Eigen::Vector2d> q;
  for (const CurvePoint& p : sample(e, n)) q.push_back(p.position());
  return q;
}

std::vector<Eigen::Vector2d> positions(const Bezier& b, int n) {
  std::vector<Eigen::Vector2d> q;
  for (int i = 0; i < n; ++i) q.push_back(evaluate(b, static_cast<double>(i) / (n - 1)).p);
  return q;
}

double directed(const std::vector<Eigen::Vector2d>& from, const std::vector<Eigen::Vector2d>& to) {
  double worst = 0;
  for (const Eigen::Vector2d& p : from) {
    double nearest = 1e300;
    for (const Eigen::Vector2d& q : to) nearest = std::min(nearest, (p - q).squaredNorm());
    worst = std::max(worst, nearest);
  }
  return std::sqrt(worst);
}

struct Case {
  Bezier bezier;
  Elastica elastica;
};

Case random_case(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  Case c;
  for (Eigen::Vector2d& p : c.bezier) p = {u(random), u(random)};
  c.elastica = {u(random), u(random), 3 * u(random), 4 * u(random), 20 * u(random), 20 * u(random), 1.5};
  return c;
}

TEST(Distance, OfABezierAgainstAShiftedCircleIsTheShift) {
  // Nearly a circle: the cubic of a 60 degree arc deviates by 1e-5 of the radius.
  const Elastica arc{0, 0, 0, 1.0 / 300, 0, 0, 300};
  const BezierFit bezier = fit_bezier(positions(arc, 65));
  Elastica shifted = arc;
  shifted.x += 0.3;
  shifted.y += 0.4;
  const CurveDistance d = distance(bezier.bezier, shifted);
  EXPECT_NEAR(d.l2 * 300, 0.5, 0.01);
  EXPECT_NEAR(d.hausdorff, 0.5, 0.01);
  EXPECT_GE(d.h1, d.l2);
  EXPECT_LT(distance(bezier.bezier, arc).hausdorff, 0.02);
}

TEST(Hausdorff, BoundsHoldAgainstDenseSampling) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 30; ++trial) {
    const Case c = random_case(random);
    constexpr int kDense = 1500;
    const auto p = positions(c.bezier, kDense), q = positions(c.elastica, kDense);
    const double dense = std::max(directed(p, q), directed(q, p));
    // Dense samples are off by half of their largest spacing, on either curve.
    const double slack = 0.5 * (2 * 6.0 / kDense + 1.5 / kDense);
    for (const double tolerance : {1e-1, 1e-3, 1e-5}) {
      const HausdorffBounds h = hausdorff(c.bezier, c.elastica, tolerance);
      EXPECT_LE(h.upper - h.lower, tolerance * (1 + 1e-9));
      EXPECT_LE(h.lower, dense + slack) << trial;
      EXPECT_GE(h.upper, dense - slack) << trial;
    }
  }
}

TEST(Hausdorff, BoundsNarrowToOneValue) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 40; ++trial) {
    const Case c = random_case(random);
    const HausdorffBounds sharp = hausdorff(c.bezier, c.elastica, 1e-7);
    for (const double tolerance : {1e-1, 1e-2, 1e-4}) {
      const HausdorffBounds h = hausdorff(c.bezier, c.elastica, tolerance);
      EXPECT_LE(h.lower, sharp.upper) << trial;
      EXPECT_GE(h.upper, sharp.lower) << trial;
    }
  }
}

TEST(Hausdorff, OfParallelLinesIsTheirSpacing) {
  const Bezier line{Eigen::Vector2d(0, 0), {1, 0}, {2, 0}, {3, 0}};
  const HausdorffBounds h = hausdorff(line, {0, 0.25, 0, 0, 0, 0, 3}, 1e-9);
  EXPECT_NEAR(h.lower, 0.25, 1e-9);
  EXPECT_NEAR(h.upper, 0.25, 1e-9);
  // The longer curve's end is what is far away, whichever it is.
  EXPECT_NEAR(hausdorff(line, {0, 0, 0, 0, 0, 0, 4}, 1e-9).upper, 1, 1e-9);
  EXPECT_NEAR(hausdorff(line, {0, 0, 0, 0, 0, 0, 1}, 1e-9).upper, 2, 1e-9);
}

TEST(Hausdorff, SeesAFootThatJumps) {
  // Points inside a deep arch have a nearest point on either leg; the farthest lies where they change over.
  const Elastica arch{-1, 0, std::acos(-1.0) / 2, -1, 0, 0, std::acos(-1.0)};
  const Bezier inside{Eigen::Vector2d(-0.6, 0), {-0.2, 0}, {0.2, 0}, {0.6, 0}};
  const HausdorffBounds h = hausdorff(inside, arch, 1e-6);
  EXPECT_NEAR(h.upper, 1, 1e-5);
  EXPECT_LE(h.upper - h.lower, 1e-6 * (1 + 1e-9));
}

TEST(Hausdorff, RefusesAToleranceOfZero) {
  const Bezier line{Eigen::Vector2d(0, 0), {1, 0}, {2, 0}, {3, 0}};
  EXPECT_THROW(static_cast<void>(hausdorff(line, {0, 0, 0, 0, 0, 0, 3}, 0)), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
