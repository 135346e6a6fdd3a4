// Planes along the direction that a surface bends the least along.
#include "pipeline/plan/direction/least_bent.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/plan/direction/body_axes.hpp"
#include "tests/pipeline/plan/extrusions.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

std::optional<NormalsTurn> turn_of(const surface::DesignSurface& design) {
  const auto along = least_steep(design.mesh);
  return along ? normals_turn(design.mesh, *along) : std::nullopt;
}

double degrees(double rad) {
  return rad * 180 / pi;
}

// The steepest of 98 of a hundred facets' normals to the planes through their middles.
double steepest_rad(const surface::TriangleMesh& mesh, const surface::PlaneFamily& planes) {
  std::vector<double> slopes;
  for (const auto& t : mesh.triangles()) {
    const auto at = [&](std::size_t i) -> const Vector3d& {
      return mesh.vertices()[static_cast<std::size_t>(t[i])];
    };
    const Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    slopes.push_back(std::asin(std::abs(normal.dot(planes.normal_at((at(0) + at(1) + at(2)) / 3)))));
  }
  std::sort(slopes.begin(), slopes.end());
  return slopes[slopes.size() * 98 / 100];
}

TEST(NormalsTurn, OfAFoldIsThatBetweenItsLegsHoweverLongTheseAre) {
  for (const double turn : {0.7, 1.2, pi / 2, 2.0}) {
    for (const double second : {60.0, 150.0, 420.0}) {
      const Eigen::Isometry3d placed = tilted_in_space();
      const auto found = turn_of(extruded({40, turn, 300, second, 900, 0.3}, placed));
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->half_rad, turn / 2, 1e-6) << turn << " " << second;
      EXPECT_LT(found->along.cross(placed.linear().col(0)).norm(), 1e-6);
      // As steep to both legs.
      const double middle = (0.5 - 0.3) * turn;
      const Vector3d up = placed.linear() * Vector3d(0, std::sin(middle), std::cos(middle));
      EXPECT_LT((found->middle - up).norm(), 1e-6) << turn << " " << second;
      EXPECT_LT(std::abs(found->planes_normal().dot(up)), 1e-6);
      EXPECT_NEAR(found->planes_normal().norm(), 1, 1e-12);
    }
  }
}

TEST(NormalsTurn, IsNotDecidedByAHundredthOfTheArea) {
  // A fold whose last cells are turned up by half a radian.
  const Fold fold{40, 1.2, 300, 300, 900};
  const auto with_lip = grid_design("lip", 20, 200, [&](double u, double v) -> Vector3d {
    const Eigen::Vector2d p = fold.at(v), q = fold.at(std::min(v, 0.994));
    return {900 * u, p.x(), p.y() + 1.2 * (q.y() - p.y())};
  });
  const auto whole = turn_of(extruded(fold)), lip = turn_of(with_lip);
  ASSERT_TRUE(whole && lip);
  EXPECT_NEAR(lip->half_rad, whole->half_rad, 1e-2);
  EXPECT_LT((lip->middle - whole->middle).norm(), 1e-2);
}

TEST(NormalsTurn, OfAColumnIsNone) {
  const auto column = grid_design("column", 90, 6, [](double u, double v) {
    return Vector3d(300 * std::cos(2 * pi * u), 300 * std::sin(2 * pi * u), 900 * v);
  });
  EXPECT_FALSE(normals_turn(column.mesh, Vector3d::UnitZ()));
}

TEST(AxisLessSteep, LiesInTheMiddleOfAnArcOrOppositeOnItsCircle) {
  for (const double turn : {1.3, 2.3, 3.2}) {
    const Eigen::Isometry3d placed = tilted_in_space();
    const auto design = extruded({60, turn, 0, 0, 700}, placed);
    const auto found = turn_of(design);
    ASSERT_TRUE(found);
    // Planes that turn as far as the normals, and half as far.
    for (const auto& [steepest, z] : {std::pair(0.0, 0.0), std::pair(0.5 * found->half_rad, -60.0)}) {
      const auto axis = axis_less_steep_than(design.mesh, *found, steepest);
      ASSERT_TRUE(axis);
      const Vector3d off = axis->point - placed * Vector3d(0, 0, z);
      // Facets' middles lie within their arc, by a sixth of a degree.
      EXPECT_LT(off.cross(placed.linear().col(0)).norm(), 0.1) << turn << " " << z;
      EXPECT_LT(axis->direction.cross(placed.linear().col(0)).norm(), 1e-6);
    }
  }
}

TEST(AxisLessSteep, KeepsSlopesAndTurnsItsPlanesAsLittle) {
  constexpr double kSteepest = 50 * pi / 180;
  for (const double turn : {2.2, 2.6, 3.0, 3.6}) {
    for (const bool hollow : {false, true}) {
      Fold fold{45, turn, 0, 0, 700};
      fold.hollow = hollow;
      const auto design = extruded(fold, tilted_in_space());
      const auto found = turn_of(design);
      ASSERT_TRUE(found);
      const auto axis = axis_less_steep_than(design.mesh, *found, kSteepest);
      ASSERT_TRUE(axis);
      const double steepest = steepest_rad(design.mesh, surface::fan_about(design.mesh, *axis));
      EXPECT_LT(degrees(steepest), 53) << turn << hollow;
      EXPECT_GT(degrees(steepest), 47) << turn << hollow;
    }
  }
}

TEST(AxisLessSteep, IsNoneWherePlanesWouldHardlyTurn) {
  const auto design = extruded({45, 1.5, 0, 0, 700});
  const auto found = turn_of(design);
  ASSERT_TRUE(found);
  EXPECT_FALSE(axis_less_steep_than(design.mesh, *found, 0.98 * found->half_rad));
}

}  // namespace
}  // namespace hotblade::pipeline
