#include "elastica/fit/fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "elastica/bezier/bezier.hpp"
#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/fit/even_points.hpp"
#include "tests/elastica/fit/ribs.hpp"

namespace hotblade::elastica {
namespace {

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

// Largest distance between points at the same share of the length.
double apart(const Elastica& a, const Elastica& b) {
  const auto p = sample(a, 101), q = sample(b, 101);
  double worst = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    worst = std::max(worst, (p[i].position() - q[i].position()).norm());
  }
  return worst;
}

TEST(FitElastica, RecoversASegmentFromThePointsThatCount) {
  std::mt19937_64 random(21);
  for (int trial = 0; trial < 50; ++trial) {
    const Elastica e = random_rib(random);
    std::vector<Eigen::Vector2d> q = positions(e, 65);
    std::vector<double> weights(q.size(), 0);
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (i >= 12 && i < 55) {
        weights[i] = 1.0 / 43;
      } else {
        q[i] += Eigen::Vector2d(0.05 * e.length, -0.03 * e.length);
      }
    }
    const Elastica start[] = {e};
    const ElasticaFit fit = fit_elastica(q, start, {0, nullptr, 0, weights});
    const std::span<const Eigen::Vector2d> counting = std::span(q).subspan(12, 43);
    EXPECT_LT(max_distance(counting, fit.elastica), 1e-6 * e.length) << trial;
    EXPECT_LT(fit.rms, 1e-6 * e.length) << trial;
  }
}

TEST(FitElastica, TakesEqualWeightsAsNone) {
  std::mt19937_64 random(22);
  const Elastica e = random_rib(random);
  std::vector<Eigen::Vector2d> q = positions(e, 65);
  for (std::size_t i = 0; i < q.size(); ++i)
    q[i].y() += 0.01 * e.length * std::sin(0.3 * static_cast<double>(i));
  const std::vector<double> weights(q.size(), 1.0 / 65);
  EXPECT_LT(
      apart(fit_elastica(q, {}, {}).elastica, fit_elastica(q, {}, {1e-6, nullptr, 0, weights}).elastica),
      1e-6 * e.length);
  EXPECT_THROW(static_cast<void>(fit_elastica(q, {}, {0, nullptr, 0, std::span(weights).first(3)})),
               std::logic_error);
}

TEST(FitElastica, RecoversASegmentFromItsOwnSamples) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Elastica e = random_rib(random);
    const ElasticaFit fit = fit_elastica(positions(e, 49), {}, kNoPull);
    EXPECT_TRUE(fit.converged) << trial;
    EXPECT_LT(apart(fit.elastica, e), 1e-9 * e.length) << trial;
    EXPECT_LT(fit.max, 1e-9 * e.length) << trial;
  }
}

TEST(FitElastica, RecoversTightlyWoundSegments) {
  // Up to two turns, several inflections.
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int trial = 0; trial < 100; ++trial) {
    const Elastica e{u(random), u(random), 3 * u(random), 10 * u(random), 90 * u(random), 90 * u(random), 1};
    EXPECT_LT(apart(fit_elastica(positions(e, 129), {}, kNoPull).elastica, e), 1e-9) << trial;
  }
}

TEST(FitElastica, RecoversLinesAndCircles) {
  for (const double kappa : {0.0, 1e-9, 1e-6, 1.0 / 400, -1.0 / 200}) {
    const Elastica e{10, 20, 0.4, kappa, 0, 0, 800};
    const ElasticaFit fit = fit_elastica(positions(e, 49), {}, kNoPull);
    EXPECT_LT(apart(fit.elastica, e), 1e-9 * e.length) << kappa;
    EXPECT_NEAR(fit.elastica.length, 800, 1e-6);
  }
}

TEST(FitElastica, PullsOnlyAsFarAsItsWeightSays) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Elastica e = random_rib(random);
    EXPECT_LT(apart(fit_elastica(positions(e, 33), {}, {}).elastica, e), 1e-5 * e.length);
    const ElasticaFit calm = fit_elastica(positions(e, 33), {}, {3e-3, nullptr, 0});
    const MidState was = mid_state(e), is = mid_state(calm.elastica);
    EXPECT_LE(std::hypot(is.tension1, is.tension2), std::hypot(was.tension1, was.tension2) * (1 + 1e-6));
    // A prior at the curve itself takes the pull back.
    const ElasticaFit held = fit_elastica(positions(e, 33), {}, {0, &was, 1});
    EXPECT_LT(apart(held.elastica, e), 1e-8 * e.length);
  }
}

TEST(FitElastica, RefusesFewBadOrCoincidentPoints) {
  std::vector<Eigen::Vector2d> q(9, Eigen::Vector2d(1, 2));
  EXPECT_THROW(static_cast<void>(fit_elastica(q, {}, {})), std::logic_error);
  EXPECT_THROW(static_cast<void>(fit_elastica(std::span(q).first(7), {}, {})), std::logic_error);
  q[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(fit_elastica(q, {}, {})), std::logic_error);
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

TEST(FitBezier, RecoversACubicFromItsOwnPoints) {
  const Bezier b{Eigen::Vector2d(0, 0), {120, 90}, {300, 140}, {420, 10}};
  std::vector<Eigen::Vector2d> q;
  for (const double t : even_parameters(b, 80)) q.push_back(evaluate(b, t).p);
  const BezierFit fit = fit_bezier(q);
  EXPECT_LT(fit.max, 0.05);
}

// Facets bring the control points nowhere: however they lie to the samples, the cubic of a faceted arc is as
// near to its corners' arc as the facets are.
TEST(FitBezier, StaysByFacetedArcs) {
  constexpr double kRadius = 490;
  for (const double turn : {0.1, 0.5, 0.8, 1.07, 2.0, 3.0}) {
    const auto arc = [&](int chords) {
      std::vector<Eigen::Vector2d> line;
      for (int i = 0; i <= chords; ++i) {
        const double angle = turn * (static_cast<double>(i) / chords - 0.5);
        line.emplace_back(kRadius * std::sin(angle), kRadius * std::cos(angle));
      }
      return line;
    };
    const double smooth = fit_bezier(arc(512)).max;
    for (int facets = 4; facets <= 80; ++facets) {
      const double sagitta = kRadius * (1 - std::cos(0.5 * turn / facets));
      const BezierFit fit = fit_bezier(evenly_spaced(arc(facets), 33));
      EXPECT_LE(fit.max, smooth + sagitta) << turn << " rad in " << facets;
    }
  }
}

// Noise of a hundredth of what an arc rises: a cubic comes nearer to it than the arc's own does.
TEST(FitBezier, StaysByNoisyArcs) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> noise(-1, 1), turns(0.05, 2.5);
  for (int trial = 0; trial < 500; ++trial) {
    const double turn = turns(random), radius = 400, rise = radius * (1 - std::cos(0.5 * turn));
    std::vector<Eigen::Vector2d> clean, noisy;
    for (int i = 0; i <= 32; ++i) {
      const double angle = turn * (i / 32.0 - 0.5), r = radius + 0.01 * rise * noise(random);
      clean.emplace_back(radius * std::sin(angle), radius * std::cos(angle));
      noisy.emplace_back(r * std::sin(angle), r * std::cos(angle));
    }
    const double own = fit_bezier(clean).rms;
    // Its ends are those of the points: the curve through them is off by as much as they are.
    EXPECT_LE(fit_bezier(noisy).rms, own + 0.015 * rise) << turn;
  }
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
