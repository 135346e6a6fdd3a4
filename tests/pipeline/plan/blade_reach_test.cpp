#include "pipeline/plan/blade_reach.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "gpu/mesh/mesh_distance.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr CutLimits kCut{1, 1 / 70.0};

// A height over the plane, in a grid of this half width.
surface::TriangleMesh graph(const std::function<double(double, double)>& height, double half_mm, int cells) {
  surface::TriangleSoup soup;
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const double x = half_mm * (2.0 * i / cells - 1), y = half_mm * (2.0 * j / cells - 1);
      soup.vertices.emplace_back(x, y, height(x, y));
    }
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int v = j * (cells + 1) + i;
      soup.triangles.push_back({v, v + 1, v + cells + 2});
      soup.triangles.push_back({v, v + cells + 2, v + cells + 1});
    }
  }
  return surface::TriangleMesh(std::move(soup));
}

double cone(double x, double y) {
  return -0.6 * std::hypot(x, y);
}
double dome(double x, double y) {
  return -(x * x + y * y) / (2 * 20.0);
}

// How far the best of many arcs that a blade may leave, through points near P and to both sides for so far,
// is off the design at most.
double best_arc_mm(const surface::TriangleMesh& mesh, const Vector3d& p, double half_mm, int arcs) {
  const gpu::MeshDistance design(mesh.vertices(), mesh.triangles());
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto direction = [&] {
    return Vector3d(normal(random), normal(random), normal(random)).normalized();
  };
  double best = std::numeric_limits<double>::infinity();
  for (int n = 0; n < arcs; ++n) {
    const Vector3d along = direction(), side = along.cross(direction()).normalized();
    const double k = kCut.curvature_per_mm * uniform(random);
    const Vector3d middle = p + kCut.tolerance_mm * uniform(random) * direction();
    std::vector<Vector3d> points;
    for (const double share : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const double s = share * half_mm;
      points.push_back(middle + std::sin(k * s) / k * along + (1 - std::cos(k * s)) / k * side);
    }
    double worst = 0;
    for (const gpu::Nearest& near : design.query(points)) worst = std::max(worst, near.distance);
    best = std::min(best, worst);
  }
  return best;
}

TEST(BladeReach, NothingIsProvedOfWhatABladeFollows) {
  const auto plane = graph([](double x, double y) { return 0.3 * x - 0.1 * y; }, 200, 40);
  EXPECT_FALSE(shortest_reach(plane, Vector3d(3, 4, 0.5), 100, kCut));
  // Sharply bent across, straight along a direction that is none of the grid's.
  const auto ridge = graph([](double x, double y) { return 30 * std::cos((x + 0.7 * y) / 20); }, 200, 120);
  EXPECT_FALSE(shortest_reach(ridge, Vector3d(0, 0, 30), 100, kCut));
  // As sharp as the blade bends, all round.
  const auto ball = graph([](double x, double y) { return std::sqrt(72 * 72 - x * x - y * y); }, 48, 60);
  EXPECT_FALSE(shortest_reach(ball, Vector3d(0, 0, 72), 40, kCut));
}

TEST(BladeReach, IsShortAtTipsAndSharpDomes) {
  const auto tip = shortest_reach(graph(cone, 200, 80), Vector3d(20, 10, -13), 60, kCut);
  ASSERT_TRUE(tip);
  EXPECT_LT(tip->at.norm(), 6);
  EXPECT_GT(tip->half_mm, 4) << tip->at.transpose();
  EXPECT_LT(tip->half_mm, 15);
  const auto top = shortest_reach(graph(dome, 60, 60), Vector3d(10, 0, -3), 40, kCut);
  ASSERT_TRUE(top);
  EXPECT_LT(top->at.norm(), 12);
  EXPECT_LT(top->half_mm, 30);
}

TEST(BladeReach, NoArcRefutesWhatIsProved) {
  struct Case {
    std::function<double(double, double)> height;
    double half_mm;
  };
  for (const Case& c : {Case{cone, 200}, Case{dome, 60}}) {
    const surface::TriangleMesh mesh = graph(c.height, c.half_mm, 80);
    const auto reach = shortest_reach(mesh, Vector3d(5, 5, c.height(5, 5)), 30, kCut);
    ASSERT_TRUE(reach);
    EXPECT_TRUE(no_blade_follows(mesh, reach->at, reach->half_mm, kCut));
    const double best = best_arc_mm(mesh, reach->at, reach->half_mm, 20'000);
    EXPECT_GT(best, kCut.tolerance_mm);
    EXPECT_LT(best, 6 * kCut.tolerance_mm) << "the arcs that are tried come nowhere near";
  }
}

TEST(BladeReach, TellsNothingWhereABladeMayLeaveTheDesign) {
  const auto mesh = graph(cone, 200, 80);
  const Vector3d tip(0, 0, 0);
  EXPECT_TRUE(no_blade_follows(mesh, tip, 20, kCut));
  const auto small = graph(cone, 15, 6);
  EXPECT_FALSE(no_blade_follows(small, tip, 20, kCut));
  // Past a half turn of the sharpest bend nothing is told.
  EXPECT_FALSE(no_blade_follows(mesh, tip, 120, kCut));
}

TEST(BladeReach, OfTolerancesFarSmallerThanFacetsIsToldWithoutAMillionSamplesEach) {
  const auto facets = graph(dome, 60, 6);  // longest edges of 20 mm and more by root of two
  const auto reach = shortest_reach(facets, Vector3d(0, 0, 0), 60, {2e-3, kCut.curvature_per_mm});
  ASSERT_TRUE(reach);
  // Samples that lie a fortieth of the length apart are 64 to the longest edge at most.
  EXPECT_GT(reach->half_mm, 40 * 20 * std::numbers::sqrt2 / 64);
}

}  // namespace
}  // namespace hotblade::pipeline
