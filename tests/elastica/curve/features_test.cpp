#include "elastica/curve/features.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

namespace hotblade::elastica {
namespace {

Elastica random_turning_elastica(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  return {10 * u(random),
          10 * u(random),
          3 * u(random),
          4 * u(random),
          5 * u(random),
          5 * u(random),
          0.05 + 6 * (u(random) + 1)};
}

// Where a sampled function changes sign.
template <typename F>
std::vector<double> sign_changes(const Elastica& e, const F& f) {
  constexpr int n = 4000;
  const std::vector<CurvePoint> points = sample(e, n + 1);
  std::vector<double> found;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double a = f(points[i - 1]), b = f(points[i]);
    if (a * b < 0) found.push_back(e.length * (static_cast<double>(i) - b / (b - a)) / n);
  }
  return found;
}

void expect_same(const std::vector<double>& exact, const std::vector<double>& sampled, double tolerance) {
  ASSERT_EQ(exact.size(), sampled.size());
  for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(exact[i], sampled[i], tolerance);
}

TEST(Inflections, AreWhereTheSampledCurvatureChangesSign) {
  std::mt19937_64 random(1);
  std::size_t seen = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Elastica e = random_turning_elastica(random);
    if (trial % 4 == 0) e.length *= 0.02;
    const std::vector<double> exact = inflections(e);
    expect_same(exact, sign_changes(e, [](const CurvePoint& p) { return p.kappa; }), 1e-5 * e.length);
    for (const double s : exact) EXPECT_NEAR(point_at(e, s).kappa, 0, 1e-9);
    seen += exact.size();
  }
  EXPECT_GT(seen, 300U);
}

TEST(Vertices, AreWhereTheSampledCurvaturesSlopeChangesSign) {
  std::mt19937_64 random(2);
  std::size_t seen = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Elastica e = random_turning_elastica(random);
    if (trial % 4 == 0) e.length *= 0.02;
    const auto slope = [&](const CurvePoint& p) {
      return e.lambda2 * std::cos(p.theta) - e.lambda1 * std::sin(p.theta);
    };
    const std::vector<double> exact = vertices(e);
    expect_same(exact, sign_changes(e, slope), 1e-5 * e.length);
    for (const double s : exact) EXPECT_NEAR(slope(point_at(e, s)), 0, 1e-8);
    seen += exact.size();
  }
  EXPECT_GT(seen, 300U);
}

TEST(Features, OfASegmentCutAtThemLieAtItsEnds) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const Elastica e = random_turning_elastica(random);
    const std::vector<double> v = vertices(e);
    if (v.size() < 2) continue;
    const std::vector<double> again = vertices(segment(e, v[0], v[1]));
    ASSERT_GE(again.size(), 1U);
    for (const double s : again) EXPECT_LT(std::min(s, std::abs(v[1] - v[0] - s)), 1e-9);
  }
}

TEST(Features, LinesAndCirclesHaveNone) {
  for (const Elastica& e : {Elastica{1, 2, 0.3, 0, 0, 0, 100}, Elastica{1, 2, 0, 0, 4, 0, 100},
                            Elastica{1, 2, 0.3, 0.5, 0, 0, 100}}) {
    EXPECT_TRUE(inflections(e).empty());
    EXPECT_TRUE(vertices(e).empty());
    EXPECT_TRUE(self_intersections(e).empty());
    EXPECT_FALSE(curvature_period(e));
  }
}

TEST(CurvaturePeriod, IsTheDistanceOfEveryOtherVertexAndRepeatsTheCurvature) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 100; ++trial) {
    Elastica e = random_turning_elastica(random);
    const double p = *curvature_period(e);
    e.length = 3.01 * p;
    const std::vector<double> v = vertices(e);
    ASSERT_GE(v.size(), 6U);
    EXPECT_NEAR(v[2] - v[0], p, 1e-11 * p);
    e.length = 1e-6 * p;
    EXPECT_NEAR(*curvature_period(e), p, 1e-12 * p);
  }
}

// Crossings of the polyline's segments that are not neighbours.
std::vector<Crossing> polyline_crossings(const Elastica& e, int n) {
  const std::vector<CurvePoint> q = sample(e, n + 1);
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  };
  std::vector<Crossing> found;
  for (std::size_t i = 0; i + 1 < q.size(); ++i) {
    for (std::size_t j = i + 2; j + 1 < q.size(); ++j) {
      const Eigen::Vector2d d = q[i + 1].position() - q[i].position(),
                            f = q[j + 1].position() - q[j].position();
      const Eigen::Vector2d g = q[j].position() - q[i].position();
      const double det = cross(d, f), a = cross(g, f) / det, b = cross(g, d) / det;
      if (!(a >= 0 && a < 1 && b >= 0 && b < 1)) continue;
      found.push_back(
          {e.length * (static_cast<double>(i) + a) / n, e.length * (static_cast<double>(j) + b) / n});
    }
  }
  return found;
}

TEST(SelfIntersections, AreThoseOfAFinePolyline) {
  std::mt19937_64 random(5);
  std::size_t seen = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const Elastica e = random_turning_elastica(random);
    const std::vector<Crossing> exact = self_intersections(e), sampled = polyline_crossings(e, 700);
    ASSERT_EQ(exact.size(), sampled.size()) << trial;
    for (const Crossing& c : exact) {
      EXPECT_LT((point_at(e, c.first).position() - point_at(e, c.second).position()).norm(), 1e-9);
      EXPECT_TRUE(c.first >= 0 && c.first < c.second && c.second <= e.length);
      double nearest = e.length;
      for (const Crossing& s : sampled) {
        nearest = std::min(nearest, std::hypot(s.first - c.first, s.second - c.second));
      }
      EXPECT_LT(nearest, 0.01 * e.length);
    }
    seen += exact.size();
  }
  EXPECT_GT(seen, 100U);
}

// The separatrix' one loop closes at 2 tanh(v) = v, v = 1.9150080481545...
TEST(SelfIntersections, OfTheSeparatrixAreItsOneLoop) {
  const Elastica e = segment({0, 0, 0, 2, 1, 0, 1}, -4, 5);
  const std::vector<Crossing> found = self_intersections(e);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].second - found[0].first, 2 * 1.9150080481545375, 1e-9);
  EXPECT_NEAR(found[0].first + found[0].second, 8, 1e-9);
}

TEST(Split, GivesPiecesThatRunOn) {
  std::mt19937_64 random(6);
  for (int trial = 0; trial < 50; ++trial) {
    const Elastica e = random_turning_elastica(random);
    const std::vector<double> at{0.2 * e.length, 0.5 * e.length, 0.9 * e.length};
    const std::vector<Elastica> pieces = split(e, at);
    ASSERT_EQ(pieces.size(), 4U);
    double s = 0;
    for (const Elastica& p : pieces) {
      EXPECT_LT((point_at(e, s + 0.3 * p.length).position() - point_at(p, 0.3 * p.length).position()).norm(),
                1e-9);
      s += p.length;
    }
    EXPECT_NEAR(s, e.length, 1e-12 * e.length);
  }
  EXPECT_THROW((void)split({0, 0, 0, 1, 0, 0, 1}, std::vector<double>{0.5, 0.4}), std::logic_error);
  EXPECT_THROW((void)split({0, 0, 0, 1, 0, 0, 1}, std::vector<double>{1.0}), std::logic_error);
}

TEST(Transformed, MapsEveryPointOfTheCurve) {
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    Elastica e = random_turning_elastica(random);
    e.length = std::min(e.length, 3.0);
    for (const bool mirrored : {false, true}) {
      const Similarity map{2.5, 0.7 + trial, mirrored, -3, 8};
      const Elastica image = transformed(e, map);
      for (const double u : {0.0, 0.4, 1.0}) {
        Eigen::Vector2d p = point_at(e, u * e.length).position();
        if (mirrored) p.y() = -p.y();
        p = 2.5 * (Eigen::Rotation2Dd(map.rotation) * p) + Eigen::Vector2d(-3, 8);
        EXPECT_LT((point_at(image, u * image.length).position() - p).norm(), 1e-9);
      }
    }
  }
  EXPECT_THROW((void)transformed({}, {0, 0, false, 0, 0}), std::logic_error);
}

TEST(Features, RefuseWhatCannotBeListed) {
  EXPECT_THROW((void)vertices({0, 0, 0, 1, 1, 0, 1e9}), std::logic_error);
  EXPECT_THROW((void)inflections({0, 0, std::nan(""), 1, 1, 0, 1}), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
