#include "elastica/arcs/arcs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace hotblade::elastica {
namespace {

using Eigen::Vector2d;

double distance_to_arc(const Arc& arc, const Vector2d& p) {
  double best =
      std::min((point_at(arc, 0).position() - p).norm(), (point_at(arc, arc.length).position() - p).norm());
  const CurvePoint start = point_at(arc, 0);
  if (std::abs(arc.kappa * arc.length) < 1e-9) {
    const double s = std::clamp((p - start.position()).dot(start.tangent()), 0.0, arc.length);
    return std::min(best, (point_at(arc, s).position() - p).norm());
  }
  const Vector2d centre = start.position() + Vector2d(-start.tangent().y(), start.tangent().x()) / arc.kappa;
  const Vector2d from = start.position() - centre, to = p - centre;
  const double turn = std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to)) / arc.kappa;
  for (const double s : {turn, turn + 2 * std::numbers::pi / std::abs(arc.kappa)}) {
    if (s >= 0 && s <= arc.length) best = std::min(best, std::abs(to.norm() - 1 / std::abs(arc.kappa)));
  }
  return best;
}

// Largest distance of points of the curve to the arcs. Arcs and curve have the same ends and run side by
// side, so the nearest arc is sought among the neighbours by length.
double deviation(const Elastica& e, const ArcFit& fit, int samples) {
  const ElasticaCurve curve(e);
  double worst = 0, done = 0;
  std::size_t k = 0;
  for (int i = 0; i <= samples; ++i) {
    const double s = e.length * i / samples;
    while (k + 1 < fit.arcs.size() && done + fit.arcs[k].length < s) done += fit.arcs[k++].length;
    double best = INFINITY;
    for (std::size_t j = k < 3 ? 0 : k - 3; j < std::min(k + 4, fit.arcs.size()); ++j) {
      best = std::min(best, distance_to_arc(fit.arcs[j], curve.at(s).position()));
    }
    worst = std::max(worst, best);
  }
  return worst;
}

Elastica random_elastica(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  const double length = 200 + 600 * (u(random) + 1), k = 0.008 * u(random);
  const double l = 1e-5 * std::pow(10, 2 * u(random)), a = std::numbers::pi * u(random);
  return {100 * u(random), 100 * u(random), std::numbers::pi * u(random), k, l * std::cos(a),
          l * std::sin(a), length};
}

// Largest jump of position or tangent from arc to arc, and to the curve's ends.
double jump(const Elastica& e, const ArcFit& fit) {
  const ElasticaCurve curve(e);
  CurvePoint at = curve.at(0);
  double worst = 0;
  const auto compare = [&](const CurvePoint& p) {
    const double turn = std::remainder(p.theta - at.theta, 2 * std::numbers::pi);
    worst = std::max({worst, (p.position() - at.position()).norm(), e.length * std::abs(turn)});
  };
  for (const Arc& arc : fit.arcs) {
    compare(point_at(arc, 0));
    at = point_at(arc, arc.length);
  }
  compare(curve.at(e.length));
  return worst;
}

void check_fits(unsigned seed, int count, int samples) {
  std::mt19937_64 random(seed);
  for (int i = 0; i < count; ++i) {
    const Elastica e = random_elastica(random);
    for (const double tolerance : {1.0, 1e-1, 1e-2, 1e-3, 1e-4}) {
      for (const ArcOrder order : {ArcOrder::kBiarc, ArcOrder::kTriarc}) {
        const ArcFit fit = fit_arcs(e, tolerance, order);
        EXPECT_LE(fit.error_bound, tolerance);
        EXPECT_NEAR(fit.length, e.length, 1e-12 * e.length);
        const double found = deviation(e, fit, samples);
        EXPECT_LE(found, fit.error_bound + 1e-9)
            << i << " at " << tolerance;  // merged curvatures move by 1e-10
        EXPECT_LT(jump(e, fit), 1e-8 * e.length);
        EXPECT_LE(fit.arcs.size(), order == ArcOrder::kBiarc ? 2 * fit.spirals : 2 * fit.spirals + 1);
      }
    }
  }
}

TEST(FitArcs, KeepTheLengthAndNeverLeaveTheBound) {
  check_fits(1, 40, 400);
}

// The full measure, by name: --gtest_also_run_disabled_tests --gtest_filter='*TenThousand*'.
TEST(FitArcs, DISABLED_KeepTheLengthAndTheBoundOnTenThousandElastica) {
  check_fits(2, 10000, 1000);
}

TEST(FitArcs, OfLinesAndCirclesAreExact) {
  for (const ArcOrder order : {ArcOrder::kBiarc, ArcOrder::kTriarc}) {
    const ArcFit line = fit_arcs({1, 2, 0.3, 0, 0, 0, 500}, 1e-6, order);
    ASSERT_EQ(line.arcs.size(), 1u);
    EXPECT_EQ(line.arcs[0].kappa, 0);
    const ArcFit circle = fit_arcs({1, 2, 0.3, 0.01, 0, 0, 100 * std::numbers::pi}, 1e-6, order);
    EXPECT_LE(circle.arcs.size(), 2u);
    for (const Arc& arc : circle.arcs) EXPECT_NEAR(arc.kappa, 0.01, 1e-15);
  }
}

TEST(FitArcs, TakeTheCubeRootOfTheToleranceInArcs) {
  // The error of a piece is of third order in its length.
  const Elastica e{0, 0, 0.2, 3e-3, 2e-5, -1e-5, 900};
  const double coarse = double(fit_arcs(e, 1e-3, ArcOrder::kBiarc).spirals);
  const double fine = double(fit_arcs(e, 1e-6, ArcOrder::kBiarc).spirals);
  EXPECT_NEAR(fine / coarse, 10, 1);
}

TEST(FitArcs, OfTriarcsHaveTheCurvatureOfTheCurveAtEveryJoint) {
  const Elastica e{0, 0, 0.2, 3e-3, 2e-5, -1e-5, 900};
  const ArcFit fit = fit_arcs(e, 1e-2, ArcOrder::kTriarc);
  EXPECT_EQ(fit.arcs.size(), 2 * fit.spirals + 1);
  const ElasticaCurve curve(e);
  EXPECT_NEAR(fit.arcs.front().kappa, curve.at(0).kappa, 1e-12);
  EXPECT_NEAR(fit.arcs.back().kappa, curve.at(e.length).kappa, 1e-9);
}

TEST(FitArcs, OfPointsFollowTheCurveTheyWereTakenFrom) {
  const Elastica e{0, 0, 0.2, 3e-3, 2e-5, -1e-5, 900};
  std::vector<Vector2d> points;
  for (const CurvePoint& p : sample(e, 400)) points.push_back(p.position());
  for (const ArcOrder order : {ArcOrder::kBiarc, ArcOrder::kTriarc}) {
    const ArcFit fit = fit_arcs(points, 0.01, order);
    EXPECT_LT(fit.arcs.size(), 120u);
    EXPECT_NEAR(fit.length, e.length, 1e-5);
    EXPECT_LT(deviation(e, fit, 800), 0.011);
  }
}

TEST(FitArcs, OfNonsenseAreRefused) {
  const Elastica e{0, 0, 0, 0.01, 0, 0, 100};
  EXPECT_THROW((void)fit_arcs(e, 0, ArcOrder::kBiarc), std::logic_error);
  EXPECT_THROW((void)fit_arcs(e, NAN, ArcOrder::kBiarc), std::logic_error);
  const Vector2d p[] = {{0, 0}, {1, 0}, {1, 0}, {2, 1}};
  EXPECT_THROW((void)fit_arcs(p, 1, ArcOrder::kBiarc), std::logic_error);
  EXPECT_THROW((void)fit_arcs(std::span(p).first(3), 1, ArcOrder::kBiarc), std::logic_error);
}

TEST(SpiralArcs, HaveTheEndsTangentsAndLengthAndCurvaturesBetweenTheEnds) {
  // Theorem 1: k1 <= q1 < q2 <= k2, with a long turning too.
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(0, 1);
  int tried = 0;
  for (int i = 0; i < 400; ++i) {
    const Elastica e{0, 0, 6 * u(random), 0, 2e-5 * u(random), 2e-5 * u(random), 3000};
    const auto breaks = spiral_breaks(e);
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
      const SpiralEnds ends{ElasticaCurve(e).at(breaks[k]), ElasticaCurve(e).at(breaks[k + 1]),
                            breaks[k + 1] - breaks[k]};
      if (std::abs(ends.b.theta - ends.a.theta) > 3) continue;
      ++tried;
      for (const ArcOrder order : {ArcOrder::kBiarc, ArcOrder::kTriarc}) {
        const auto found = spiral_arcs(ends, order);
        ASSERT_TRUE(found);
        double length = 0, last = ends.a.kappa;
        const double sense = ends.b.kappa > ends.a.kappa ? 1 : -1;
        for (const Arc& arc : found->arcs) {
          length += arc.length;
          EXPECT_GE(sense * (arc.kappa - last), -1e-9 * std::abs(ends.b.kappa - ends.a.kappa));
          last = arc.kappa;
        }
        EXPECT_GE(sense * (ends.b.kappa - last), -1e-9 * std::abs(ends.b.kappa - ends.a.kappa));
        EXPECT_NEAR(length, ends.length, 1e-12 * ends.length);
        const CurvePoint end = point_at(found->arcs.back(), found->arcs.back().length);
        EXPECT_LT((end.position() - ends.b.position()).norm(), 1e-10 * ends.length);
        EXPECT_NEAR(end.theta, ends.b.theta, 1e-10);
      }
    }
  }
  EXPECT_GT(tried, 400);
}

TEST(BiarcFamily, HasItsLimitLengthsAndTheJointOnTheBisectorOfTheLens) {
  const BiarcFamily f = *BiarcFamily::between({-1, 0, -0.7, 0}, {1, 0, 1.5, 0});
  EXPECT_NEAR(f.length(1e-9), 2 * f.beta / std::sin(f.beta), 1e-8);
  EXPECT_NEAR(f.length(1e9), 2 * f.alpha / std::sin(f.alpha), 1e-8);
  double last = INFINITY;  // |alpha| < |beta|: strictly decreasing
  for (double p = 0.01; p < 100; p *= 1.3) {
    EXPECT_LT(f.length(p), last);
    last = f.length(p);
    const auto two = f.arcs(p);
    EXPECT_NEAR(two[0].kappa, f.first_curvature(p), 1e-12);
    EXPECT_NEAR(two[1].kappa, f.second_curvature(p), 1e-12);
    const Vector2d joint = point_at(two[1], 0).position();
    const Vector2d a = joint - Vector2d(-1, 0), b = Vector2d(1, 0) - joint;
    // Seen from the bisector, an arc with end slope gamma, the chord turns by -gamma.
    EXPECT_NEAR(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)), -f.gamma(), 1e-12);
    EXPECT_LT((point_at(two[1], two[1].length).position() - Vector2d(1, 0)).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace hotblade::elastica
