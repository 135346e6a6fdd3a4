// The distance against an independent tree: CGAL's AABB tree.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gpu/mesh/mesh_distance.hpp"
#include "tests/gpu/soup.hpp"

namespace hotblade::gpu {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using KernelTriangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, KernelTriangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

// A height field with n x n cells over a square of the given side.
test::Soup height_field(int n, double side) {
  test::Soup soup;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = side * i / n, y = side * j / n;
      soup.vertices.emplace_back(x, y, 0.1 * side * std::sin(6 * x / side) * std::cos(5 * y / side));
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      soup.triangles.push_back({a, b, d});
      soup.triangles.push_back({a, d, c});
    }
  }
  return soup;
}

void expect_matches_cgal(const test::Soup& soup, const std::vector<Eigen::Vector3d>& points, double bound) {
  KernelTriangles triangles;
  for (const auto& t : soup.triangles) {
    const auto corner = [&](std::size_t k) {
      const Eigen::Vector3d& v = soup.vertices[static_cast<std::size_t>(t[k])];
      return Kernel::Point_3(v.x(), v.y(), v.z());
    };
    triangles.emplace_back(corner(0), corner(1), corner(2));
  }
  Tree tree(triangles.cbegin(), triangles.cend());
  tree.accelerate_distance_queries();
  const auto answers = MeshDistance(soup.vertices, soup.triangles).query(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Kernel::Point_3 q(points[i].x(), points[i].y(), points[i].z());
    ASSERT_NEAR(answers[i].distance, std::sqrt(tree.squared_distance(q)), bound) << "point " << i;
  }
}

TEST(MeshDistance, MatchesTheCgalTreeOnAHeightField) {
  std::mt19937_64 rng(11);
  const test::Soup soup = height_field(80, 1000);
  expect_matches_cgal(soup, test::random_points(rng, 20000, 700, {500, 500, 0}), 1e-9);
}

TEST(MeshDistance, MatchesTheCgalTreeOnARandomSoup) {
  std::mt19937_64 rng(12);
  const test::Soup soup = test::random_soup(rng, 5000, 500, 25);
  expect_matches_cgal(soup, test::random_points(rng, 20000, 600), 1e-9);
}

}  // namespace
}  // namespace hotblade::gpu
