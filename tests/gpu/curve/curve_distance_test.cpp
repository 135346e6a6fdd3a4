// Points to curves on every backend against brute force in extended precision.
#include "gpu/curve/curve_distance.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "gpu/curve/curve_lanes.hpp"
#include "gpu/curve/curve_search.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector2d;
using Cubic = std::array<Vector2d, 4>;
using Chain = std::vector<std::array<Vector2d, 3>>;
using Wide = Eigen::Matrix<long double, 2, 1>;

// Polynomials one after the other, by their control points.
struct Curve {
  std::vector<std::vector<Vector2d>> parts;
  bool cubic = false;
};
Curve curve_of(const Cubic& c) {
  return {{{c.begin(), c.end()}}, true};
}
Curve curve_of(const Chain& chain) {
  Curve curve;
  for (const auto& q : chain) curve.parts.emplace_back(q.begin(), q.end());
  return curve;
}

CurveDistance prepared(const Curve& c, Backend backend) {
  if (c.cubic) {
    return CurveDistance::to_cubic({c.parts[0][0], c.parts[0][1], c.parts[0][2], c.parts[0][3]}, backend);
  }
  Chain chain;
  for (const auto& p : c.parts) chain.push_back({p[0], p[1], p[2]});
  return CurveDistance::to_quadratics(chain, backend);
}

Wide at(const std::vector<Vector2d>& control, long double t) {
  std::array<Wide, 4> p;
  std::transform(control.begin(), control.end(), p.begin(),
                 [](const Vector2d& c) { return c.cast<long double>(); });
  for (std::size_t left = control.size() - 1; left > 0; --left) {
    for (std::size_t i = 0; i < left; ++i) p[i] += t * (p[i + 1] - p[i]);
  }
  return p[0];
}
Wide at(const Curve& c, double t) {
  const auto part = std::min(c.parts.size() - 1, static_cast<std::size_t>(t));
  return at(c.parts[part], static_cast<long double>(t) - static_cast<long double>(part));
}

// By another road: golden sections about every local minimum of many samples.
long double brute_force(const std::vector<Vector2d>& part, const Vector2d& q, int samples) {
  const auto distance = [&](long double t) { return (at(part, t) - q.cast<long double>()).norm(); };
  std::vector<long double> d;
  for (int i = 0; i <= samples; ++i) d.push_back(distance(static_cast<long double>(i) / samples));
  long double best = *std::min_element(d.begin(), d.end());
  const auto last = static_cast<std::size_t>(samples);
  for (std::size_t i = 0; i <= last; ++i) {
    const std::size_t before = i > 0 ? i - 1 : i, after = i < last ? i + 1 : i;
    if (d[i] > d[before] || (after > i && d[i] >= d[after])) continue;
    long double low = static_cast<long double>(before) / samples,
                high = static_cast<long double>(after) / samples;
    for (int n = 0; n < 60; ++n) {
      const long double a = high - 0.618033988749894848L * (high - low),
                        b = low + 0.618033988749894848L * (high - low);
      (distance(a) < distance(b) ? high : low) = distance(a) < distance(b) ? b : a;
    }
    best = std::min(best, distance((low + high) / 2));
  }
  return best;
}

std::size_t expect_nearest(const Curve& curve, const std::vector<Vector2d>& points, Backend backend) {
  std::vector<double> x, y, distance(points.size()), t(points.size());
  const Vector2d origin = curve.parts[0][0];
  double size = 0;
  for (const auto& part : curve.parts) {
    for (const Vector2d& c : part) size = std::max(size, (c - origin).cwiseAbs().maxCoeff());
  }
  for (const Vector2d& q : points) {
    x.push_back(q.x());
    y.push_back(q.y());
  }
  const std::size_t careful = prepared(curve, backend).query(x, y, distance, t);
  const int samples = curve.parts.size() > 1 ? 200 : 1000;
  for (std::size_t i = 0; i < points.size(); ++i) {
    long double nearest = std::numeric_limits<long double>::infinity();
    for (const auto& part : curve.parts) nearest = std::min(nearest, brute_force(part, points[i], samples));
    // Coordinates far from the origin are rounded before they reach the curve's frame.
    const double bound =
        CurveDistance::kErrorRel * std::max(size, (points[i] - origin).cwiseAbs().maxCoeff()) +
        4e-16 * points[i].cwiseAbs().maxCoeff();
    EXPECT_NEAR(distance[i], static_cast<double>(nearest), bound) << "point " << i;
    EXPECT_NEAR(static_cast<double>((at(curve, t[i]) - points[i].cast<long double>()).norm()), distance[i],
                bound);
    EXPECT_TRUE(t[i] >= 0 && t[i] <= static_cast<double>(curve.parts.size()));
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

Cubic random_cubic(std::mt19937_64& rng, double half, const Vector2d& centre = {0, 0}) {
  const auto c = points_around(rng, 4, half, centre);
  return {c[0], c[1], c[2], c[3]};
}

// Quadratics end to end, smooth at every second joint.
Chain random_chain(std::mt19937_64& rng, int n) {
  Chain chain;
  Vector2d from(0, 0), middle(0.3, 0.2);
  for (int i = 0; i < n; ++i) {
    const auto c = points_around(rng, 2, 0.5, from);
    if (i % 2 == 0) middle = c[0];
    chain.push_back({from, middle, c[1]});
    from = c[1];
    middle = 2 * c[1] - middle;
  }
  return chain;
}

// The contract: every backend answers every question within kErrorRel. A backend that is not at hand is
// skipped.
class CurveDistanceOnEachBackend : public testing::TestWithParam<Backend> {
 protected:
  void SetUp() override {
    const CurveDistance curve = CurveDistance::to_cubic({{{0, 0}, {1, 1}, {2, 1}, {3, 0}}}, GetParam());
    std::vector<double> one{0.5}, distance(1), t(1);
    (void)curve.query(one, one, distance, t);
    if (curve.used().backend != GetParam()) GTEST_SKIP() << curve.used().reason;
  }
};

TEST_P(CurveDistanceOnEachBackend, MatchesBruteForceOnRandomCubics) {
  std::mt19937_64 rng(1);
  for (int n = 0; n < 20; ++n) {
    expect_nearest(curve_of(random_cubic(rng, 1)), points_around(rng, 25, n % 2 == 0 ? 1.5 : 20), GetParam());
  }
}

TEST_P(CurveDistanceOnEachBackend, MatchesBruteForceOnCuspsLoopsAndDegenerateCubics) {
  std::mt19937_64 rng(2);
  const Cubic curves[] = {
      {{{0, 0}, {1, 1}, {0, 1}, {1, 0}}},             // cusp
      {{{0, 0}, {2, 1}, {-1, 1}, {1, 0}}},            // loop
      {{{0, 0}, {0.6, 0.8}, {0.4, 0.8}, {1, 0}}},     // arch with two equal minima above its axis
      {{{0, 0}, {1, 0}, {2, 0}, {3, 0}}},             // uniform line
      {{{0, 0}, {3, 0}, {-2, 0}, {1, 0}}},            // line that turns back twice
      {{{0, 0}, {0, 0}, {1, 1}, {1, 1}}},             // zero end tangents
      {{{2, 3}, {2, 3}, {2, 3}, {2, 3}}},             // one point
      {{{0, 0}, {0.5, 0}, {0.5, 1e-12}, {1, 1e-12}}}  // nearly straight
  };
  for (const Cubic& c : curves) {
    const Curve curve = curve_of(c);
    std::vector<Vector2d> points = points_around(rng, 40, 2, {0.5, 0.5});
    for (int i = 0; i <= 10; ++i) points.emplace_back(0.5, -0.5 + 0.15 * i);
    for (int i = 0; i <= 10; ++i) points.push_back(at(curve, 0.1 * i).cast<double>());
    expect_nearest(curve, points, GetParam());
  }
}

TEST_P(CurveDistanceOnEachBackend, MatchesBruteForceOnRandomQuadraticsAndChains) {
  std::mt19937_64 rng(3);
  for (const int n : {1, 1, 1, 2, 3, 7, 20}) {
    const Curve curve = curve_of(random_chain(rng, n));
    std::vector<Vector2d> points = points_around(rng, 20, 2);
    for (int i = 0; i <= n; ++i) points.push_back(at(curve, i).cast<double>());
    expect_nearest(curve, points, GetParam());
  }
}

TEST_P(CurveDistanceOnEachBackend, MatchesBruteForceOnDegenerateQuadratics) {
  std::mt19937_64 rng(4);
  const Chain chains[] = {
      {{{{0, 0}, {1, 0}, {2, 0}}}},                              // uniform line
      {{{{0, 0}, {3, 0}, {1, 0}}}},                              // fold
      {{{{0, 0}, {1, 0}, {0, 0}}}},                              // there and back
      {{{{1, 2}, {1, 2}, {1, 2}}}},                              // one point
      {{{{0, 0}, {0, 0}, {1, 1}}}},                              // zero end tangent
      {{{{0, 0}, {0.5, 1e-13}, {1, 0}}}},                        // nearly straight
      {{{{-1, 1}, {0, -1}, {1, 1}}}},                            // parabola: two equal minima on its axis
      {{{{0, 0}, {1, 0}, {1, 1}}}, {{{1, 1}, {1, 0}, {0, 0}}}},  // there and back by two
      {{{{0, 0}, {1, 0}, {2, 0}}}, {{{2, 0}, {2, 0}, {2, 0}}}, {{{2, 0}, {3, 1}, {4, 0}}}}  // a point between
  };
  for (const Chain& chain : chains) {
    const Curve curve = curve_of(chain);
    std::vector<Vector2d> points = points_around(rng, 40, 2, {0.5, 0.5});
    for (int i = 0; i <= 10; ++i) points.emplace_back(0, -0.5 + 0.2 * i);
    for (int i = 0; i <= 10; ++i) {
      points.push_back(at(curve, 0.1 * i * static_cast<double>(chain.size())).cast<double>());
    }
    expect_nearest(curve, points, GetParam());
  }
}

TEST_P(CurveDistanceOnEachBackend, MatchesBruteForceFarFromTheOriginAndAtEveryScale) {
  std::mt19937_64 rng(5);
  for (const double scale : {1e-100, 1e-6, 1.0, 1e6, 1e100}) {
    const Vector2d offset(3e3 * scale, -2e3 * scale);
    expect_nearest(curve_of(random_cubic(rng, scale, offset)), points_around(rng, 30, 2 * scale, offset),
                   GetParam());
  }
}

TEST_P(CurveDistanceOnEachBackend, MatchesBruteForceForPointsFarAway) {
  std::mt19937_64 rng(6);
  const Curve cubic = curve_of(random_cubic(rng, 1)), chain = curve_of(random_chain(rng, 5));
  for (const double far : {1e3, 1e8, 1e20, 1e140, 1e200}) {
    expect_nearest(cubic, points_around(rng, 10, far), GetParam());
    expect_nearest(chain, points_around(rng, 10, far), GetParam());
  }
}

TEST_P(CurveDistanceOnEachBackend, AnswersDoNotDependOnThreadsOrTheOtherPoints) {
  std::mt19937_64 rng(7);
  const CurveDistance curve = prepared(curve_of(Cubic{{{0, 0}, {1, 1}, {0, 1}, {1, 0}}}), GetParam());
  const std::size_t n = 10007;
  std::vector<double> x, y;
  for (const Vector2d& p : points_around(rng, static_cast<int>(n), 1, {0.5, 0.5})) {
    x.push_back(p.x());
    y.push_back(p.y());
  }
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::vector<double> both(2 * n);
    (void)curve.query(x, y, std::span(both).first(n), std::span(both).subspan(n));
    return both;
  };
  const auto one = on(1);
  EXPECT_EQ(on(2), one);
  std::reverse(x.begin(), x.end());
  std::reverse(y.begin(), y.end());
  auto backwards = on(2);
  std::reverse(backwards.begin(), backwards.begin() + n);
  std::reverse(backwards.begin() + n, backwards.end());
  EXPECT_EQ(backwards, one);
}

TEST_P(CurveDistanceOnEachBackend, AnswersNoneForNoneAndNanForNan) {
  const CurveDistance curve = CurveDistance::to_cubic({{{0, 0}, {1, 1}, {2, 1}, {3, 0}}}, GetParam());
  std::vector<double> two(2), one(1);
  EXPECT_THROW((void)curve.query(two, one, two, two), std::logic_error);
  EXPECT_EQ(curve.query({}, {}, {}, {}), 0u);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> x{0.5, nan, std::numeric_limits<double>::infinity()}, y{0.5, 0.5, 0}, distance(3), t(3);
  (void)curve.query(x, y, distance, t);
  EXPECT_TRUE(std::isfinite(distance[0]) && std::isnan(distance[1]) && std::isnan(distance[2]));
}

INSTANTIATE_TEST_SUITE_P(, CurveDistanceOnEachBackend, testing::Values(Backend::kCpu, Backend::kOpenCl),
                         [](const auto& instantiation) {
                           return instantiation.param == Backend::kCpu ? "Cpu" : "OpenCl";
                         });

TEST(CurveDistance, NeedsTheCarefulSearchForFewPoints) {
  std::mt19937_64 rng(8);
  const auto share = [&](const Cubic& c, const Vector2d& centre, double half) {
    const auto points = points_around(rng, 2000, half, centre);
    std::vector<double> x, y, distance(points.size()), t(points.size());
    for (const Vector2d& q : points) {
      x.push_back(q.x());
      y.push_back(q.y());
    }
    const std::size_t careful = CurveDistance::to_cubic(c).query(x, y, distance, t);
    return static_cast<double>(careful) / static_cast<double>(points.size());
  };
  EXPECT_LT(share({{{0, 0}, {300, 120}, {700, 140}, {1000, 0}}}, {500, 100}, 400), 0.01);
  EXPECT_LT(share({{{0, 0}, {1, 1}, {0, 1}, {1, 0}}}, {0.5, 0.5}, 1), 0.2);
}

std::vector<CurveLanes> supported_lanes() {
  std::vector<CurveLanes> lanes{kCurveBaseline};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) lanes.push_back(kCurveAvx2);
  if (__builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) lanes.push_back(kCurveAvx512);
#endif
  return lanes;
}

TEST(CurveDistance, EveryInstructionSetProvesPointsToTheSameDistance) {
  constexpr std::size_t kPoints = 21;
  for (const CurveLanes& lanes : supported_lanes()) {
    std::mt19937_64 rng(9);
    std::size_t proven = 0;
    for (int n = 0; n < 10; ++n) {
      const Cubic c = random_cubic(rng, 1);
      const CurvePieces curve = pieces_of_cubic(c);
      const auto points = points_around(rng, kPoints, 1.5);
      std::vector<double> x, y, distance(kPoints), t(kPoints);
      for (const Vector2d& q : points) {
        x.push_back(q.x());
        y.push_back(q.y());
      }
      for (const bool whole : {true, false}) {
        std::vector<unsigned> unsure(kPoints + 8);
        const CurveQueries queries{x.data(), y.data(),        curve.origin.x(), curve.origin.y(), curve.scale,
                                   kPoints,  distance.data(), t.data(),         unsure.data()};
        unsure.resize(whole ? lanes.whole(*curve.whole, queries)
                            : lanes.pieces(curve.pieces.data(), static_cast<int>(curve.pieces.size()),
                                           curve.sag, queries));
        for (unsigned i = 0; i < kPoints; ++i) {
          if (std::find(unsure.begin(), unsure.end(), i) != unsure.end()) continue;
          ++proven;
          const long double expected = brute_force(curve_of(c).parts[0], points[i], 1000);
          EXPECT_NEAR(distance[i], static_cast<double>(expected), 4 * CurveDistance::kErrorRel);
        }
      }
    }
    EXPECT_GT(proven, 100u);
  }
}

TEST(CurveDistance, RefusesWhatIsNotACurve) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)CurveDistance::to_cubic({{{0, nan}, {1, 1}, {2, 1}, {3, 0}}}), std::logic_error);
  EXPECT_THROW((void)CurveDistance::to_quadratics({}), std::logic_error);
  EXPECT_THROW((void)CurveDistance::to_quadratics(Chain{{{{0, 0}, {1, nan}, {2, 0}}}}), std::logic_error);
  const Chain apart{{{{0, 0}, {1, 1}, {2, 0}}}, {{{2, 1}, {3, 1}, {4, 0}}}};
  EXPECT_THROW((void)CurveDistance::to_quadratics(apart), std::logic_error);
}

}  // namespace
}  // namespace hotblade::gpu
