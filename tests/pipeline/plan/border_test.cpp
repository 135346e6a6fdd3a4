// Designs whose borders are neither along nor across the ribs: the blade cuts on through the waste, so that
// they plan as a rectangle does.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A flat mesh, to be bent onto a cylinder.
struct Outline {
  std::vector<Vector2d> points;
  std::vector<std::array<std::size_t, 3>> triangles;
};

// 40 x 40 cells of the unit square, mapped.
Outline grid(const std::function<Vector2d(double, double)>& p) {
  constexpr std::size_t kCells = 40;
  Outline mesh;
  for (std::size_t i = 0; i <= kCells; ++i) {
    for (std::size_t j = 0; j <= kCells; ++j)
      mesh.points.push_back(p(static_cast<double>(i) / kCells, static_cast<double>(j) / kCells));
  }
  for (std::size_t i = 0; i < kCells; ++i) {
    for (std::size_t j = 0; j < kCells; ++j) {
      const std::size_t a = i * (kCells + 1) + j, c = a + kCells + 1;
      mesh.triangles.push_back({a, c, c + 1});
      mesh.triangles.push_back({a, c + 1, a + 1});
    }
  }
  return mesh;
}

// Rings about a middle: a grid of quadrilaterals has no good triangles at the ends of a disc.
Outline disc() {
  constexpr std::size_t kRings = 24, kAround = 90;
  Outline mesh{{Vector2d::Zero()}, {}};
  for (std::size_t i = 1; i <= kRings; ++i) {
    for (std::size_t j = 0; j < kAround; ++j) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(j) / kAround;
      mesh.points.push_back(static_cast<double>(i) / kRings * Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  for (std::size_t i = 0; i < kRings; ++i) {
    for (std::size_t j = 0; j < kAround; ++j) {
      const std::size_t next = (j + 1) % kAround, inner = 1 + (i - 1) * kAround, outer = 1 + i * kAround;
      mesh.triangles.push_back({i > 0 ? inner + j : 0, outer + j, outer + next});
      if (i > 0) mesh.triangles.push_back({inner + j, outer + next, inner + next});
    }
  }
  return mesh;
}
// Its tip is a fraction of a millimetre wide: the mesh has no faces without area.
Outline triangle() {
  return grid([](double u, double v) { return Vector2d((2 * v - 1) * (1 - 0.999 * u), 2 * u - 1); });
}
Outline parallelogram() {
  return grid([](double u, double v) { return Vector2d(2 * v - 1 + 0.6 * (2 * u - 1), 2 * u - 1); });
}
Outline trapezium() {
  return grid([](double u, double v) { return Vector2d((2 * v - 1) * (1 - 0.6 * u), 2 * u - 1); });
}
Outline s_shape() {
  return grid([](double u, double v) {
    return Vector2d(2 * v - 1 + 0.45 * std::sin(2 * std::numbers::pi * u), 2 * u - 1);
  });
}

// A square with a window of 0.8 x 0.8 in its middle.
Outline frame() {
  Outline mesh = grid([](double u, double v) { return Vector2d(2 * v - 1, 2 * u - 1); });
  std::erase_if(mesh.triangles, [&](const std::array<std::size_t, 3>& t) {
    const Vector2d middle = (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3;
    return middle.cwiseAbs().maxCoeff() < 0.4;
  });
  return mesh;
}

// Part of a cylinder of 900 mm about y, the outline scaled to 300 mm: its exact sections are circles.
constexpr double kRadius = 900, kScale = 300;
Vector3d on_cylinder(const Vector2d& q) {
  const double x = kScale * q.x();
  return {x, kScale * q.y(), std::sqrt(kRadius * kRadius - x * x)};
}

surface::DesignSurface design_of(const Outline& outline) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "outline.obj";
  {
    std::ofstream out(file);
    out.precision(17);
    for (const Vector2d& q : outline.points) {
      const Vector3d p = on_cylinder(q);
      out << "v " << p.x() << " " << p.y() << " " << p.z() << "\n";
    }
    for (const auto& t : outline.triangles)
      out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  }
  return surface::read_obj(file, {"mm", 'z'});
}

// How far the facets lie inside the cylinder, at the most: at the middle of the edge with the longest chord
// across it.
double mesh_error_mm(const Outline& outline) {
  double longest = 0;
  for (const auto& t : outline.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d chord = on_cylinder(outline.points[t[k]]) - on_cylinder(outline.points[t[(k + 1) % 3]]);
      longest = std::max(longest, std::hypot(chord.x(), chord.z()));
    }
  }
  return kRadius - std::sqrt(kRadius * kRadius - 0.25 * longest * longest);
}

// Ribs may be as far off as the facets.
PlanResult plan_outline(const Outline& outline) {
  Settings settings;
  settings.design.units = "mm";
  settings.slice.direction = {{0, 1, 0}};
  settings.fit.deviation_share = mesh_error_mm(outline) / settings.design.tolerance_mm;
  return plan(design_of(outline), settings, {});
}

class Border : public ::testing::TestWithParam<Outline (*)()> {};

TEST_P(Border, OfACylinderIsReachedInOneStripOfFewRibsWithinTheErrorOfItsMesh) {
  const double error = mesh_error_mm(GetParam()());
  const PlanResult result = plan_outline(GetParam()());
  for (const Refusal& r : result.refusals) ADD_FAILURE() << describe(r);
  ASSERT_EQ(result.strips.size(), 1u);
  EXPECT_LE(result.strips[0].ribs, 8u);
  EXPECT_EQ(result.verification.uncut_mm2, 0);
  EXPECT_LE(result.verification.deviation.max, 1.5 * error)
      << "at " << result.verification.deviation.at.transpose();
  EXPECT_GE(result.strips[0].motion.slowest_feed_mm_s, 3);
}

// What the program says of a rib is the design's part of it alone.
TEST_P(Border, IsWhereTheProgramsRibsEnd) {
  const PlanResult result = plan_outline(GetParam()());
  ASSERT_EQ(result.program.strips.size(), 1u);
  for (const Rib& rib : result.program.strips[0].ribs) {
    const Vector2d first = rib.target.front(), last = rib.target.back();
    EXPECT_NEAR(first.norm(), 0, 1e-9);
    const auto at = [&](double s) { return elastica::point_at(rib.elastica, s).position(); };
    EXPECT_LT((at(0) - first).norm(), 1);
    EXPECT_LT((at(rib.elastica.length) - last).norm(), 1);
    EXPECT_LT((rib.bezier.front() - first).norm(), 1);
    EXPECT_LT((rib.bezier.back() - last).norm(), 1);
    EXPECT_LE(elastica::max_distance(rib.target, rib.elastica), rib.design_deviation_mm + 1e-9);
    EXPECT_LE(rib.design_deviation_mm, 1.2 * mesh_error_mm(GetParam()()));
  }
}

std::string outline_name(const ::testing::TestParamInfo<Outline (*)()>& outline) {
  constexpr std::array kNames{"Disc", "Triangle", "Parallelogram", "Trapezium", "SShape", "Frame"};
  return kNames.at(outline.index);
}

INSTANTIATE_TEST_SUITE_P(Outlines, Border,
                         ::testing::Values(disc, triangle, parallelogram, trapezium, s_shape, frame),
                         outline_name);

TEST(BorderSplits, OfAWideTriangleIsCutInTwoStripsOfWhichTheNarrowOneIsShorter) {
  Settings settings;
  settings.design.units = "mm";
  settings.slice.direction = {{0, 1, 0}};
  const auto design = grid_design("wide", 50, 80, [](double u, double v) {
    const double x = 620 * ((2 * v - 1) * (1 - 0.999 * u) + 0.7 * u);
    return Vector3d(x, 400 * u, std::sqrt(1500.0 * 1500 - x * x));
  });
  const PlanResult result = plan(design, settings, {});
  for (const Refusal& r : result.refusals) ADD_FAILURE() << describe(r);
  ASSERT_EQ(result.strips.size(), 2u);
  EXPECT_EQ(result.verification.uncut_mm2, 0);
  const auto sweep = [&](std::size_t i) { return result.program.strips[i].block.size_mm.z(); };
  EXPECT_LT(std::min(sweep(0), sweep(1)), 400);
  EXPECT_GT(std::max(sweep(0), sweep(1)), 400);
}

}  // namespace
}  // namespace hotblade::pipeline
