#include "gpu/mesh/mesh_distance.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/gpu/soup.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector3d;
using test::random_points;
using test::random_soup;
using test::Soup;
// 113 bits, so that even a triangle as thin as double precision can hold has a sound normal.
__extension__ using Quad = __float128;
using Quad3 = std::array<Quad, 3>;

Quad3 quad(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Quad3 minus(const Quad3& a, const Quad3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Quad dot(const Quad3& a, const Quad3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Quad3 cross(const Quad3& a, const Quad3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Quad segment_distance_sq(const Quad3& q, const Quad3& a, const Quad3& b) {
  const Quad3 e = minus(b, a), r = minus(q, a);
  const Quad length_sq = dot(e, e);
  const Quad t = length_sq > 0 ? std::clamp<Quad>(dot(r, e) / length_sq, 0, 1) : 0;
  const Quad3 off = minus(r, {t * e[0], t * e[1], t * e[2]});
  return dot(off, off);
}

// By another road than the library: plane distance when the foot is on the inner side of all three edges,
// else the nearest edge.
long double triangle_distance(const Vector3d& point, const Soup& soup, std::size_t triangle) {
  const Quad3 q = quad(point);
  std::array<Quad3, 3> p;
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = quad(soup.vertices[static_cast<std::size_t>(soup.triangles[triangle][k])]);
  const Quad3 normal = cross(minus(p[1], p[0]), minus(p[2], p[0]));
  const Quad area_sq = dot(normal, normal);
  bool inside = area_sq > 0;
  Quad nearest_sq = segment_distance_sq(q, p[2], p[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Quad3 &a = p[k], &b = p[(k + 1) % 3];
    inside = inside && dot(normal, cross(minus(b, a), minus(q, a))) >= 0;
    nearest_sq = std::min(nearest_sq, segment_distance_sq(q, a, b));
  }
  if (inside) {
    const Quad height = dot(normal, minus(q, p[0]));
    nearest_sq = height * height / area_sq;
  }
  return std::sqrt(static_cast<long double>(nearest_sq));
}

double largest_coordinate(const Soup& soup, const Vector3d& point) {
  double size = point.cwiseAbs().maxCoeff();
  for (const Vector3d& v : soup.vertices) size = std::max(size, v.cwiseAbs().maxCoeff());
  return size;
}

// Distance, triangle and point of every answer against all triangles.
void expect_matches_brute_force(const Soup& soup, const std::vector<Vector3d>& points, Backend backend) {
  const MeshDistance mesh(soup.vertices, soup.triangles, backend);
  const std::vector<Nearest> answers = mesh.query(points);
  ASSERT_EQ(answers.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    long double expected = std::numeric_limits<long double>::infinity();
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
      expected = std::min(expected, triangle_distance(points[i], soup, t));
    }
    const double bound = MeshDistance::kDistanceErrorRel * largest_coordinate(soup, points[i]);
    const Nearest& answer = answers[i];
    ASSERT_NEAR(answer.distance, static_cast<double>(expected), bound) << "point " << i;
    ASSERT_GE(answer.triangle, 0);
    ASSERT_LT(static_cast<std::size_t>(answer.triangle), soup.triangles.size());
    const auto triangle = static_cast<std::size_t>(answer.triangle);
    EXPECT_NEAR(static_cast<double>(triangle_distance(points[i], soup, triangle)),
                static_cast<double>(expected), bound);
    EXPECT_NEAR((answer.point - points[i]).norm(), answer.distance, 2 * bound) << "point " << i;
    EXPECT_LE(static_cast<double>(triangle_distance(answer.point, soup, triangle)), 2 * bound)
        << "point " << i;
  }
}

// The contract: every backend answers every question with the same values. A backend that is not at hand is
// skipped.
class MeshDistanceOnEachBackend : public testing::TestWithParam<Backend> {
 protected:
  void SetUp() override {
    const MeshDistance mesh(std::vector<Vector3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                            std::vector<std::array<int, 3>>{{0, 1, 2}}, GetParam());
    (void)mesh.query(std::vector<Vector3d>{{0, 0, 1}});
    if (mesh.used().backend != GetParam()) GTEST_SKIP() << mesh.used().reason;
  }
};

TEST_P(MeshDistanceOnEachBackend, MatchesBruteForceOnRandomSoups) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937_64 rng(seed);
    const double size = std::pow(10.0, -3.0 + 0.4 * seed);
    expect_matches_brute_force(random_soup(rng, 1 + static_cast<int>(seed) * 34, 100, size),
                               random_points(rng, 60, 130), GetParam());
  }
}

TEST_P(MeshDistanceOnEachBackend, MatchesBruteForceForPointsOnAndCloseToTheSurface) {
  std::mt19937_64 rng(1);
  const Soup soup = random_soup(rng, 200, 100, 20);
  std::uniform_real_distribution<double> u(0, 1), magnitude(-15, 0);
  std::vector<Vector3d> points;
  for (const auto& t : soup.triangles) {
    const double s = std::sqrt(u(rng)), v = u(rng), off = std::pow(10.0, magnitude(rng));
    points.emplace_back((1 - s) * soup.vertices[static_cast<std::size_t>(t[0])] +
                        s * (1 - v) * soup.vertices[static_cast<std::size_t>(t[1])] +
                        s * v * soup.vertices[static_cast<std::size_t>(t[2])] + test::random_point(rng, off));
    points.push_back(soup.vertices[static_cast<std::size_t>(t[0])]);
  }
  expect_matches_brute_force(soup, points, GetParam());
}

TEST_P(MeshDistanceOnEachBackend, MatchesBruteForceForPointsFarAway) {
  std::mt19937_64 rng(2);
  const Soup soup = random_soup(rng, 100, 100, 30);
  for (const double far : {1e3, 1e5, 1e7, 5e8, 1e12, 1e100}) {
    expect_matches_brute_force(soup, random_points(rng, 40, far), GetParam());
  }
}

TEST_P(MeshDistanceOnEachBackend, MatchesBruteForceFarFromTheOrigin) {
  std::mt19937_64 rng(3);
  const Vector3d offset(1e6, -2e6, 3e6);
  expect_matches_brute_force(random_soup(rng, 300, 100, 5, offset), random_points(rng, 500, 120, offset),
                             GetParam());
}

TEST_P(MeshDistanceOnEachBackend, KeepsDetailFarSmallerThanSinglePrecisionResolves) {
  // Two sheets 1e-9 apart in a mesh of size 1: both fall on the same single-precision plane.
  Soup soup;
  for (const double z : {0.0, 1e-9}) {
    const int first = static_cast<int>(soup.vertices.size());
    soup.vertices.insert(soup.vertices.end(), {{-1, -1, z}, {1, -1, z}, {0, 1, z}});
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const MeshDistance mesh(soup.vertices, soup.triangles, GetParam());
  const std::vector<Vector3d> points{{0, 0, -0.5}, {0, 0, 0.5}, {0, 0, 0.9e-9}, {0, 0, 0.1e-9}};
  const auto answers = mesh.query(points);
  EXPECT_EQ(answers[0].triangle, 0);
  EXPECT_EQ(answers[1].triangle, 1);
  EXPECT_EQ(answers[2].triangle, 1);
  EXPECT_EQ(answers[3].triangle, 0);
  EXPECT_NEAR(answers[2].distance, 0.1e-9, 1e-15);
}

TEST_P(MeshDistanceOnEachBackend, TakesDegenerateTrianglesAsTheSegmentOrPointTheyAre) {
  const Soup soup{{{0, 0, 0}, {10, 0, 0}, {4, 0, 0}, {0, 50, 0}}, {{0, 1, 2}, {3, 3, 3}, {0, 0, 1}}};
  const MeshDistance mesh(soup.vertices, soup.triangles, GetParam());
  const auto answers = mesh.query(std::vector<Vector3d>{{5, 3, 0}, {14, 3, 0}, {-3, 0, 4}, {1, 50, 0}});
  EXPECT_DOUBLE_EQ(answers[0].distance, 3);
  EXPECT_EQ(answers[0].triangle, 0);
  EXPECT_DOUBLE_EQ(answers[1].distance, 5);
  EXPECT_DOUBLE_EQ(answers[2].distance, 5);
  EXPECT_DOUBLE_EQ(answers[3].distance, 1);
  EXPECT_EQ(answers[3].triangle, 1);
}

TEST_P(MeshDistanceOnEachBackend, MatchesBruteForceOnNeedlesAndCaps) {
  std::mt19937_64 rng(4);
  for (const double width : {1e-3, 1e-6, 1e-9, 1e-12, 1e-14}) {
    Soup soup;
    for (int i = 0; i < 60; ++i) {
      const Vector3d a = test::random_point(rng, 100), b = test::random_point(rng, 100);
      const double where = i % 2 == 0 ? 1.0 : 0.4;  // a needle, or a cap with its apex over the long edge
      soup.vertices.insert(soup.vertices.end(), {a, b, a + where * (b - a) + test::random_point(rng, width)});
      soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    std::vector<Vector3d> points = random_points(rng, 200, 120);
    for (std::size_t i = 0; i < 60; ++i) {
      points.emplace_back(0.3 * soup.vertices[3 * i] + 0.7 * soup.vertices[3 * i + 1] +
                          test::random_point(rng, width));
    }
    expect_matches_brute_force(soup, points, GetParam());
  }
}

TEST_P(MeshDistanceOnEachBackend, TakesTheLowestTriangleAmongEqualOnes) {
  std::mt19937_64 rng(5);
  const Soup once = random_soup(rng, 50, 10, 3);
  Soup thrice = once;
  for (int copy = 0; copy < 2; ++copy) {
    thrice.triangles.insert(thrice.triangles.end(), once.triangles.begin(), once.triangles.end());
  }
  const MeshDistance mesh(thrice.vertices, thrice.triangles, GetParam()),
      single(once.vertices, once.triangles, GetParam());
  const auto points = random_points(rng, 2000, 12);
  const auto answers = mesh.query(points), expected = single.query(points);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(answers[i].triangle, expected[i].triangle);
}

TEST_P(MeshDistanceOnEachBackend, AnswersForOneTriangle) {
  const Soup soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const MeshDistance mesh(soup.vertices, soup.triangles, GetParam());
  const auto answers = mesh.query(std::vector<Vector3d>{{0.25, 0.25, 2}, {-3, -4, 0}, {1, 1, 0}});
  EXPECT_EQ(answers[0].distance, 2);
  EXPECT_TRUE(answers[0].point.isApprox(Vector3d(0.25, 0.25, 0), 1e-15));
  EXPECT_DOUBLE_EQ(answers[1].distance, 5);
  EXPECT_DOUBLE_EQ(answers[2].distance, std::sqrt(0.5));
}

bool same_bits(const Nearest& a, const Nearest& b) {
  return a.distance == b.distance && a.triangle == b.triangle && a.point == b.point;
}

TEST_P(MeshDistanceOnEachBackend, AnswersDoNotDependOnTheNumberOfThreadsOrTheOrderOfPoints) {
  std::mt19937_64 rng(6);
  const Soup soup = random_soup(rng, 3000, 100, 4);
  std::vector<Vector3d> points = random_points(rng, 10007, 120);
  const MeshDistance mesh(soup.vertices, soup.triangles, GetParam());
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return mesh.query(points);
  };
  const auto one = on(1), two = on(2), eight = on(8);
  std::reverse(points.begin(), points.end());
  auto backwards = on(2);
  std::reverse(backwards.begin(), backwards.end());
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_TRUE(same_bits(one[i], two[i]) && same_bits(one[i], eight[i]) && same_bits(one[i], backwards[i]))
        << i;
  }
}

TEST_P(MeshDistanceOnEachBackend, ScalesAndMovesWithTheMesh) {
  std::mt19937_64 rng(7);
  const Soup soup = random_soup(rng, 100, 100, 20);
  const auto points = random_points(rng, 200, 150);
  const auto expected = MeshDistance(soup.vertices, soup.triangles, GetParam()).query(points);
  for (const double scale : {0x1p-300, 0x1p-20, 0x1p+40, 0x1p+300}) {
    Soup scaled = soup;
    for (Vector3d& v : scaled.vertices) v *= scale;
    std::vector<Vector3d> moved = points;
    for (Vector3d& p : moved) p *= scale;
    const auto answers = MeshDistance(scaled.vertices, scaled.triangles, GetParam()).query(moved);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(answers[i].distance, expected[i].distance * scale);
      EXPECT_EQ(answers[i].triangle, expected[i].triangle);
    }
  }
}

TEST_P(MeshDistanceOnEachBackend, RefusesWhatIsNotAMesh) {
  const std::vector<Vector3d> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using Triangles = std::vector<std::array<int, 3>>;
  EXPECT_THROW(MeshDistance(vertices, Triangles{}), std::logic_error);
  EXPECT_THROW(MeshDistance(std::vector<Vector3d>{}, Triangles{}), std::logic_error);
  EXPECT_THROW(MeshDistance(vertices, Triangles{{0, 1, 3}}), std::logic_error);
  EXPECT_THROW(MeshDistance(vertices, Triangles{{0, -1, 2}}), std::logic_error);
  EXPECT_THROW(MeshDistance(std::vector<Vector3d>{{0, 0, 0}, {1, nan, 0}, {0, 1, 0}}, Triangles{{0, 1, 2}}),
               std::logic_error);
  const MeshDistance mesh(vertices, Triangles{{0, 1, 2}});
  EXPECT_THROW((void)mesh.query(std::vector<Vector3d>{{0, 0, nan}}), std::logic_error);
  EXPECT_TRUE(mesh.query(std::vector<Vector3d>{}).empty());
}

TEST_P(MeshDistanceOnEachBackend, AnswersWithTheCpusBits) {
  std::mt19937_64 rng(8);
  const Soup soup = random_soup(rng, 2000, 100, 6);
  std::vector<Vector3d> points = random_points(rng, 3000, 130);
  for (const auto& t : soup.triangles) points.push_back(soup.vertices[static_cast<std::size_t>(t[1])]);
  points.emplace_back(1e9, 0, 0);
  const auto expected = MeshDistance(soup.vertices, soup.triangles, Backend::kCpu).query(points);
  const auto answers = MeshDistance(soup.vertices, soup.triangles, GetParam()).query(points);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_TRUE(same_bits(answers[i], expected[i])) << i;
}

TEST_P(MeshDistanceOnEachBackend, AnswersWhereMoreTrianglesTieThanADeviceKeeps) {
  // The tip of a cone of 40 triangles is the nearest point of each of them.
  Soup cone;
  cone.vertices.emplace_back(0, 0, 10);
  for (int i = 0; i < 40; ++i) {
    cone.vertices.emplace_back(std::cos(0.05 * M_PI * i), std::sin(0.05 * M_PI * i), 0);
    cone.triangles.push_back({0, 1 + i, 1 + (i + 1) % 40});
  }
  expect_matches_brute_force(cone, {{0, 0, 12}, {0.1, 0, 20}, {0, 0, 10}}, GetParam());
}

INSTANTIATE_TEST_SUITE_P(, MeshDistanceOnEachBackend, testing::Values(Backend::kCpu, Backend::kOpenCl),
                         [](const auto& instantiation) {
                           return instantiation.param == Backend::kCpu ? "Cpu" : "OpenCl";
                         });

TEST(MeshDistanceBackend, AutoSaysWhatItPickedAndWhy) {
  std::mt19937_64 rng(9);
  const Soup soup = random_soup(rng, 100, 100, 6);
  const MeshDistance mesh(soup.vertices, soup.triangles, Backend::kAuto);
  (void)mesh.query(random_points(rng, 1000, 130));
  EXPECT_EQ(mesh.used().backend, Backend::kCpu);
  EXPECT_NE(mesh.used().reason.find("less than starting a device"), std::string::npos) << mesh.used().reason;
}

}  // namespace
}  // namespace hotblade::gpu
