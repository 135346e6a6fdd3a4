#include "elastica/fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "elastica/lambda_residual.hpp"

namespace hotblade::elastica {
namespace {

std::vector<Eigen::Vector2d> positions(const Elastica& e, int n) {
  std::vector<Eigen::Vector2d> q;
  for (const CurvePoint& p : sample(e, n)) q.push_back(p.position());
  return q;
}

// Ribs as blades cut them: up to 2 rad of turning, with and without an inflection, 300 to 1200 mm.
Elastica random_rib(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  const double length = 750 + 450 * u(random);
  return {500 * u(random),
          500 * u(random),
          3 * u(random),
          2 * u(random) / length,
          8 * u(random) / (length * length),
          8 * u(random) / (length * length),
          length};
}

TEST(MidState, RoundTrips) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Elastica e = random_rib(random);
    const Elastica back = from_mid_state(mid_state(e));
    EXPECT_LT((ElasticaCurve(e).at(0).position() - ElasticaCurve(back).at(0).position()).norm(), 1e-9);
    EXPECT_LT((ElasticaCurve(e).at(e.length).position() - ElasticaCurve(back).at(e.length).position()).norm(),
              1e-9);
  }
}

TEST(FitElastica, RecoversASegmentFromItsOwnSamples) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Elastica e = random_rib(random);
    const std::vector<Eigen::Vector2d> q = positions(e, 49);
    const BezierFit bezier = fit_bezier(q);
    const std::vector<Elastica> starts{first_guess(bezier.bezier, lambda_residual(bezier.bezier))};
    FitOptions options;
    options.tension_weight = 1e-12;
    const ElasticaFit fit = fit_elastica(q, starts, options);
    EXPECT_LT(fit.max, 1e-6 * e.length) << trial;
  }
}

TEST(FitElastica, RecoversLinesAndCircles) {
  for (const double kappa : {0.0, 1e-6, 1.0 / 400}) {
    const std::vector<Eigen::Vector2d> q = positions({10, 20, 0.4, kappa, 0, 0, 800}, 49);
    const BezierFit bezier = fit_bezier(q);
    const std::vector<Elastica> starts{first_guess(bezier.bezier, lambda_residual(bezier.bezier))};
    const ElasticaFit fit = fit_elastica(q, starts, {});
    EXPECT_LT(fit.max, 1e-6) << kappa;
    EXPECT_NEAR(fit.elastica.length, 800, 1e-5);
  }
}

TEST(FitElastica, MaxIsTheLargestDistanceFromThePoints) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 0.5);
  for (int trial = 0; trial < 20; ++trial) {
    const Elastica e = random_rib(random);
    std::vector<Eigen::Vector2d> q = positions(e, 33);
    for (auto& p : q) p += Eigen::Vector2d(noise(random), noise(random));
    const std::vector<Elastica> starts{e};
    const ElasticaFit fit = fit_elastica(q, starts, {});
    double brute = 0;
    const auto dense = sample(fit.elastica, 40001);
    for (const auto& p : q) {
      double nearest = 1e300;
      for (const auto& s : dense) nearest = std::min(nearest, (s.position() - p).norm());
      brute = std::max(brute, nearest);
    }
    EXPECT_NEAR(fit.max, brute, 1e-3);
  }
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

TEST(FitBezier, RecoversACubicFromItsOwnPoints) {
  const Bezier b{Eigen::Vector2d(0, 0), {120, 90}, {300, 140}, {420, 10}};
  std::vector<Eigen::Vector2d> q;
  for (const double t : even_parameters(b, 80)) q.push_back(evaluate(b, t).p);
  const BezierFit fit = fit_bezier(q);
  EXPECT_LT(fit.max, 0.05);
}

TEST(EvenParameters, SpacePointsEvenlyByArcLength) {
  const Bezier b{Eigen::Vector2d(0, 0), {500, 90}, {-100, 140}, {420, 10}};
  const std::vector<double> t = even_parameters(b, 33);
  const double length = arc_lengths(b, 2000).back();
  for (std::size_t i = 1; i < t.size(); ++i) {
    double piece = 0;
    for (int k = 0; k < 200; ++k) {
      piece +=
          evaluate(b, t[i - 1] + (t[i] - t[i - 1]) * (k + 0.5) / 200).d1.norm() * (t[i] - t[i - 1]) / 200;
    }
    EXPECT_NEAR(piece, length / 32, 1e-4 * length);
  }
}

}  // namespace
}  // namespace hotblade::elastica
