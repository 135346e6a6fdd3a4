#include "gpu/curve_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "gpu/cubic_lanes.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector2d;
using Control = std::array<Vector2d, 4>;
using Wide = Eigen::Matrix<long double, 2, 1>;

Wide at(const Control& p, long double t) {
  const long double s = 1 - t;
  return s * s * s * p[0].cast<long double>() + 3 * s * s * t * p[1].cast<long double>() +
         3 * s * t * t * p[2].cast<long double>() + t * t * t * p[3].cast<long double>();
}

// By another road: golden sections about every local minimum of 4000 samples.
double brute_force(const Control& p, const Vector2d& q) {
  constexpr int kSamples = 4000;
  const auto distance = [&](long double t) { return (at(p, t) - q.cast<long double>()).norm(); };
  std::vector<long double> d;
  for (int i = 0; i <= kSamples; ++i) d.push_back(distance(static_cast<long double>(i) / kSamples));
  long double best = std::min(d.front(), d.back());
  for (std::size_t i = 0; i <= kSamples; ++i) {
    const std::size_t before = i > 0 ? i - 1 : i, after = i < kSamples ? i + 1 : i;
    if (d[i] > d[before] || d[i] > d[after]) continue;
    long double low = static_cast<long double>(before) / kSamples,
                high = static_cast<long double>(after) / kSamples;
    for (int n = 0; n < 60; ++n) {
      const long double a = high - 0.618033988749894848L * (high - low),
                        b = low + 0.618033988749894848L * (high - low);
      (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
    }
    best = std::min(best, distance((low + high) / 2));
  }
  return static_cast<double>(best);
}

std::size_t expect_nearest(const Control& p, const std::vector<Vector2d>& points) {
  std::vector<double> x, y, distance(points.size()), t(points.size());
  double size = 0;
  for (const Vector2d& q : points) {
    x.push_back(q.x());
    y.push_back(q.y());
    size = std::max(size, (q - p[0]).cwiseAbs().maxCoeff());
  }
  for (const Vector2d& c : p) size = std::max(size, (c - p[0]).cwiseAbs().maxCoeff());
  const std::size_t careful = CubicDistance(p).query(x, y, distance, t);
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Coordinates far from the origin are rounded before they reach the curve's frame.
    const double bound = CubicDistance::kErrorRel * size + 4e-16 * points[i].cwiseAbs().maxCoeff();
    EXPECT_NEAR(distance[i], brute_force(p, points[i]), bound) << "point " << i;
    EXPECT_NEAR(static_cast<double>((at(p, t[i]) - points[i].cast<long double>()).norm()), distance[i],
                bound);
    EXPECT_TRUE(t[i] >= 0 && t[i] <= 1);
  }
  return careful;
}

std::vector<Vector2d> points_around(std::mt19937_64& rng, int n, double half,
                                    const Vector2d& centre = {0, 0}) {
  std::uniform_real_distribution<double> u(-half, half);
  std::vector<Vector2d> points;
  for (int i = 0; i < n; ++i) {
    const double x = u(rng);
    points.push_back(centre + Vector2d(x, u(rng)));
  }
  return points;
}

TEST(CubicDistance, MatchesBruteForceOnRandomCurves) {
  std::mt19937_64 rng(1);
  for (int n = 0; n < 20; ++n) {
    const auto c = points_around(rng, 4, 1);
    expect_nearest({c[0], c[1], c[2], c[3]}, points_around(rng, 25, n % 2 == 0 ? 1.5 : 20));
  }
}

TEST(CubicDistance, MatchesBruteForceOnCuspsLoopsAndDegenerateCurves) {
  std::mt19937_64 rng(2);
  const Control curves[] = {
      {{{0, 0}, {1, 1}, {0, 1}, {1, 0}}},             // cusp
      {{{0, 0}, {2, 1}, {-1, 1}, {1, 0}}},            // loop
      {{{0, 0}, {0.6, 0.8}, {0.4, 0.8}, {1, 0}}},     // arch with two equal minima above its axis
      {{{0, 0}, {1, 0}, {2, 0}, {3, 0}}},             // uniform line
      {{{0, 0}, {3, 0}, {-2, 0}, {1, 0}}},            // line that turns back twice
      {{{0, 0}, {0, 0}, {1, 1}, {1, 1}}},             // zero end tangents
      {{{2, 3}, {2, 3}, {2, 3}, {2, 3}}},             // one point
      {{{0, 0}, {0.5, 0}, {0.5, 1e-12}, {1, 1e-12}}}  // nearly straight
  };
  for (const Control& c : curves) {
    std::vector<Vector2d> points = points_around(rng, 40, 2, {0.5, 0.5});
    for (int i = 0; i <= 10; ++i) points.emplace_back(0.5, -0.5 + 0.15 * i);
    for (int i = 0; i <= 10; ++i) points.push_back(at(c, 0.1L * i).cast<double>());
    expect_nearest(c, points);
  }
}

TEST(CubicDistance, MatchesBruteForceFarFromTheOriginAndAtEveryScale) {
  std::mt19937_64 rng(3);
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const Vector2d offset(3e3 * scale, -2e3 * scale);
    const auto c = points_around(rng, 4, scale, offset);
    expect_nearest({c[0], c[1], c[2], c[3]}, points_around(rng, 40, 2 * scale, offset));
  }
}

TEST(CubicDistance, NeedsTheCarefulSearchForFewPointsNearAGentleCurve) {
  std::mt19937_64 rng(4);
  const Control rib{{{0, 0}, {300, 120}, {700, 140}, {1000, 0}}};
  const auto points = points_around(rng, 2000, 400, {500, 100});
  std::vector<double> x, y, distance(points.size()), t(points.size());
  for (const Vector2d& q : points) {
    x.push_back(q.x());
    y.push_back(q.y());
  }
  EXPECT_LT(CubicDistance(rib).query(x, y, distance, t), points.size() / 20);
}

std::vector<NearestOnCubic> supported_ways() {
  std::vector<NearestOnCubic> ways{nearest_on_cubic_baseline};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) ways.push_back(nearest_on_cubic_avx2);
  if (__builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    ways.push_back(nearest_on_cubic_avx512);
#endif
  return ways;
}

TEST(CubicDistance, EveryInstructionSetSettlesPointsToTheSameDistance) {
  std::mt19937_64 rng(5);
  for (const NearestOnCubic way : supported_ways()) {
    std::size_t settled = 0;
    for (int n = 0; n < 10; ++n) {
      const auto c = points_around(rng, 4, 1);
      const Control control{c[0], c[1], c[2], c[3]};
      const auto points = points_around(rng, 21, 1.5);
      std::vector<double> x, y, distance(21), t(21);
      for (const Vector2d& q : points) {
        x.push_back(q.x());
        y.push_back(q.y());
      }
      std::vector<unsigned> unsure(32);
      unsure.resize(way(make_chords(control), x.data(), y.data(), c[0].x(), c[0].y(), 21, distance.data(),
                        t.data(), unsure.data()));
      for (unsigned i = 0; i < 21; ++i) {
        if (std::find(unsure.begin(), unsure.end(), i) != unsure.end()) continue;
        ++settled;
        EXPECT_NEAR(distance[i], brute_force(control, points[i]), 4 * CubicDistance::kErrorRel);
      }
    }
    EXPECT_GT(settled, 100u);
  }
}

TEST(CubicDistance, RefusesSpansThatDifferAndAnswersNoneForNone) {
  const CubicDistance curve({{{0, 0}, {1, 1}, {2, 1}, {3, 0}}});
  std::vector<double> two(2), one(1);
  EXPECT_THROW((void)curve.query(two, one, two, two), std::logic_error);
  EXPECT_EQ(curve.query({}, {}, {}, {}), 0u);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(CubicDistance({{{0, nan}, {1, 1}, {2, 1}, {3, 0}}}), std::logic_error);
  two = {0.5, nan};
  std::vector<double> y{0.5, 0.5}, distance(2), t(2);
  (void)curve.query(two, y, distance, t);
  EXPECT_TRUE(std::isfinite(distance[0]) && std::isnan(distance[1]));
}

}  // namespace
}  // namespace hotblade::gpu
