// Sides of closed meshes against the winding number, the sum of the solid angles of all triangles, which
// knows nothing of nearest points.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "gpu/mesh/mesh_distance.hpp"
#include "tests/gpu/soup.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector3d;
using test::Soup;
using Wide = Eigen::Matrix<long double, 3, 1>;

// Van Oosterom and Strackee's formula; 1 inside, 0 outside, to rounding.
long double winding_number(const Soup& soup, const Vector3d& q) {
  long double sum = 0;
  for (const auto& t : soup.triangles) {
    std::array<Wide, 3> r;
    for (std::size_t k = 0; k < 3; ++k) {
      r[k] = (soup.vertices[static_cast<std::size_t>(t[k])] - q).cast<long double>();
    }
    const long double a = r[0].norm(), b = r[1].norm(), c = r[2].norm();
    const long double below = a * b * c + r[0].dot(r[1]) * c + r[0].dot(r[2]) * b + r[1].dot(r[2]) * a;
    sum += 2 * std::atan2(r[0].dot(r[1].cross(r[2])), below);
  }
  return sum / (4 * std::numbers::pi_v<long double>);
}

// A closed star about the origin with sharp spikes and valleys; rows meet in triangles without area at both
// poles.
Soup star(int rows, int columns, double spike) {
  Soup soup;
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double polar = std::numbers::pi * i / rows, around = 2 * std::numbers::pi * j / columns;
      const double radius = 1 + ((i + j) % 2 == 0 ? spike : -spike) * std::sin(polar) * std::sin(polar);
      const double across = i == 0 || i == rows ? 0 : std::sin(polar);
      soup.vertices.push_back(
          radius * Vector3d(across * std::cos(around), across * std::sin(around), std::cos(polar)));
    }
  }
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int a = i * columns + j, b = i * columns + (j + 1) % columns, c = a + columns, d = b + columns;
      soup.triangles.push_back({a, c, d});
      soup.triangles.push_back({a, d, b});
    }
  }
  return soup;
}

// Every triangle with vertices of its own.
Soup torn(const Soup& soup) {
  Soup out;
  for (const auto& t : soup.triangles) {
    const int first = static_cast<int>(out.vertices.size());
    for (const int i : t) out.vertices.push_back(soup.vertices[static_cast<std::size_t>(i)]);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

std::vector<Side> sides_of(const Soup& soup, const std::vector<Vector3d>& points, Backend backend) {
  const MeshDistance mesh(soup.vertices, soup.triangles, backend);
  return mesh.sides(points, mesh.query(points));
}

void expect_matches_winding_number(const Soup& soup, const std::vector<Vector3d>& points, Backend backend) {
  const std::vector<Side> sides = sides_of(soup, points, backend);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Side expected = winding_number(soup, points[i]) > 0.5L ? Side::kBehind : Side::kBefore;
    ASSERT_EQ(sides[i], expected) << "point " << i << ": " << points[i].transpose();
  }
}

// Points that see a vertex or an edge as the nearest feature: off every vertex, along directions of all
// kinds.
std::vector<Vector3d> points_at_vertices(const Soup& soup, std::mt19937_64& rng, double off) {
  std::vector<Vector3d> points;
  for (const Vector3d& v : soup.vertices) {
    points.push_back((1 + off) * v);
    points.push_back((1 - off) * v);
    points.push_back(v + test::random_point(rng, off));
  }
  return points;
}

class MeshSideOnEachBackend : public testing::TestWithParam<Backend> {};

TEST_P(MeshSideOnEachBackend, MatchesTheWindingNumberAroundSharpSpikesAndValleys) {
  std::mt19937_64 rng(1);
  for (const double spike : {0.0, 0.3, 0.7, 0.9}) {
    const Soup soup = star(8, 14, spike);
    expect_matches_winding_number(soup, test::random_points(rng, 1000, 2), GetParam());
    for (const double off : {0.3, 1e-2, 1e-6}) {
      expect_matches_winding_number(soup, points_at_vertices(soup, rng, off), GetParam());
    }
  }
}

TEST_P(MeshSideOnEachBackend, JoinsVerticesAtTheSamePlace) {
  std::mt19937_64 rng(2);
  const Soup soup = torn(star(8, 14, 0.8));
  expect_matches_winding_number(soup, test::random_points(rng, 1000, 2), GetParam());
  expect_matches_winding_number(soup, points_at_vertices(soup, rng, 1e-3), GetParam());
}

TEST_P(MeshSideOnEachBackend, HoldsFarAwayAndFarFromTheOriginAtEveryScale) {
  std::mt19937_64 rng(3);
  const Soup soup = star(8, 14, 0.7);
  std::vector<Vector3d> points = test::random_points(rng, 500, 2);
  points.emplace_back(1e9, -1e9, 3e8);
  points.emplace_back(0, 0, 1e100);
  const std::vector<Side> expected = sides_of(soup, points, GetParam());
  for (const double scale : {0x1p-300, 0x1p+20}) {
    Soup moved = soup;
    std::vector<Vector3d> there = points;
    for (Vector3d& v : moved.vertices) v = scale * (v + Vector3d(64, -32, 16));
    for (Vector3d& p : there) p = scale * (p + Vector3d(64, -32, 16));
    EXPECT_EQ(sides_of(moved, there, GetParam()), expected);
  }
}

TEST_P(MeshSideOnEachBackend, IsNeitherOnTheMeshAndBesideTrianglesWithoutArea) {
  const Soup soup{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {9, 9, 9}, {10, 10, 10}}, {{0, 1, 2}, {3, 4, 3}}};
  const std::vector<Vector3d> points{{1, 1, 0},    {0, 0, 0},     {2, 2, 0},
                                     {1, 1, 1e-9}, {1, 1, -1e-9}, {9, 9, 10}};
  EXPECT_EQ(sides_of(soup, points, GetParam()), (std::vector{Side::kNeither, Side::kNeither, Side::kNeither,
                                                             Side::kBefore, Side::kBehind, Side::kNeither}));
}

TEST_P(MeshSideOnEachBackend, TurnsOverWithTheFaces) {
  std::mt19937_64 rng(4);
  Soup soup = star(8, 14, 0.7);
  const auto points = test::random_points(rng, 500, 2);
  const auto sides = sides_of(soup, points, GetParam());
  for (auto& t : soup.triangles) std::swap(t[1], t[2]);
  const auto turned = sides_of(soup, points, GetParam());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(static_cast<int>(turned[i]), -static_cast<int>(sides[i]));
  }
}

INSTANTIATE_TEST_SUITE_P(, MeshSideOnEachBackend, testing::Values(Backend::kCpu, Backend::kOpenCl),
                         [](const auto& instantiation) {
                           return instantiation.param == Backend::kCpu ? "Cpu" : "OpenCl";
                         });

TEST(MeshSide, IsWrongByTheNearestFacesOwnNormalWhereTheMeshIsSharp) {
  std::mt19937_64 rng(5);
  const Soup soup = star(8, 14, 0.9);
  const auto points = test::random_points(rng, 2000, 2);
  const MeshDistance mesh(soup.vertices, soup.triangles);
  const auto answers = mesh.query(points);
  const auto sides = mesh.sides(points, answers);
  int different = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& t = soup.triangles[static_cast<std::size_t>(answers[i].triangle)];
    const auto at = [&](std::size_t k) { return soup.vertices[static_cast<std::size_t>(t[k])]; };
    const double height = (points[i] - answers[i].point).dot((at(1) - at(0)).cross(at(2) - at(0)));
    different += (height > 0) != (sides[i] == Side::kBefore);
  }
  EXPECT_GT(different, 20);
}

TEST(MeshSide, RefusesAnswersOfAnotherMesh) {
  const Soup soup = star(4, 6, 0);
  const MeshDistance mesh(soup.vertices, soup.triangles);
  const std::vector<Vector3d> points{{0, 0, 0}};
  auto answers = mesh.query(points);
  answers[0].triangle = static_cast<int>(soup.triangles.size());
  EXPECT_THROW((void)mesh.sides(points, answers), std::logic_error);
  EXPECT_THROW((void)mesh.sides(points, {}), std::logic_error);
  EXPECT_TRUE(mesh.sides({}, {}).empty());
}

}  // namespace
}  // namespace hotblade::gpu
