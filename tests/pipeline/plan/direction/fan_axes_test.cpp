#include "pipeline/plan/direction/fan_axes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "pipeline/plan/direction/border_runs.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using surface::FanAxis;

Eigen::Isometry3d turned_about() {
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  t.rotate(Eigen::AngleAxisd(1.3, Vector3d(-1, 2, 0.4).normalized()));
  t.translation() = Vector3d(-900, 5000, 320);
  return t;
}

struct Miss {
  double angle_rad = 0, distance_mm = 0;
};

// How far an axis is from the line through `p` along `d`; the distance is that of p.
Miss miss(const FanAxis& axis, const Vector3d& p, const Vector3d& d) {
  const Vector3d u = axis.direction.normalized();
  return {std::asin(std::min(1.0, u.cross(d.normalized()).norm())), u.cross(p - axis.point).norm()};
}

Miss nearest(const std::vector<FanAxis>& axes, const Vector3d& p, const Vector3d& d) {
  Miss best{10, 1e9};
  for (const FanAxis& axis : axes) {
    const Miss m = miss(axis, p, d);
    if (m.angle_rad + m.distance_mm / 1000 < best.angle_rad + best.distance_mm / 1000) best = m;
  }
  return best;
}

std::vector<FanAxis> axes_of(const surface::DesignSurface& design) {
  return fan_axes(design.mesh, body_axes(design.mesh), long_sides(design.mesh));
}

// A panel of a cone about z, 300 to 500 mm off it, through `turn` radians.
surface::DesignSurface cone(const Eigen::Isometry3d& placed, double turn, int nu = 48, int nv = 8) {
  return grid_design("cone", nu, nv, [&](double u, double v) -> Vector3d {
    const double a = turn * u, out = 300 + 200 * v;
    return placed * Vector3d(out * std::cos(a), out * std::sin(a), 250 * v);
  });
}

// An arch bent round z whose rise changes on the way: no surface of revolution, with plane ends.
surface::DesignSurface bend(const Eigen::Isometry3d& placed) {
  return grid_design("bend", 60, 40, [&](double u, double v) -> Vector3d {
    const double a = 1.1 * u, out = 320 + 380 * v, across = 2 * v - 1;
    return placed * Vector3d(out * std::cos(a), out * std::sin(a), (70 + 30 * u * u) * (1 - across * across));
  });
}

TEST(BorderRuns, AreTheSidesBetweenCorners) {
  const auto runs = border_runs(cone(turned_about(), 0.9).mesh);
  ASSERT_EQ(runs.size(), 4u);
  EXPECT_NEAR(runs[0].length_mm, 0.9 * 500, 0.01);  // chords of 48 cells
  EXPECT_NEAR(runs[1].length_mm, std::hypot(200, 250), 1e-9);
  EXPECT_NEAR(runs[2].length_mm, std::hypot(200, 250), 1e-9);
  EXPECT_NEAR(runs[3].length_mm, 0.9 * 300, 0.01);
}

TEST(BorderRuns, ABorderWithoutCornersIsOneClosedRun) {
  const auto ring = grid_design("ring", 72, 4, [](double u, double v) {
    const double a = 2 * pi * u;
    return Vector3d((200 + 50 * v) * std::cos(a), (200 + 50 * v) * std::sin(a), 60 * v);
  });
  // Reading merges no vertices, so the ring has a seam; its two circles are runs between the seam's ends.
  for (const BorderRun& run : border_runs(ring.mesh)) {
    if (run.points.size() < 70) continue;
    const auto axis = circle_axis(run);
    ASSERT_TRUE(axis);
    EXPECT_LT(miss(*axis, Vector3d::Zero(), Vector3d::UnitZ()).distance_mm, 1e-9);
  }
}

TEST(CircleAxis, IsExactForPointsOfAnArc) {
  for (const double turn : {0.12, 0.5, 1.5, 3.0, 6.0}) {
    BorderRun run;
    const Eigen::Isometry3d placed = turned_about();
    for (int i = 0; i <= 40; ++i) {
      const double a = turn * i / 40;
      run.points.push_back(placed * Vector3d(700 * std::cos(a), 700 * std::sin(a), 12));
      if (i > 0) run.length_mm += (run.points.end()[-1] - run.points.end()[-2]).norm();
    }
    const auto axis = circle_axis(run);
    ASSERT_TRUE(axis) << turn;
    const Miss m = miss(*axis, placed * Vector3d::Zero(), placed.linear() * Vector3d::UnitZ());
    // Rounding of 5000 mm, by how little a short arc rises.
    const double rounding = 1e-11 / (1 - std::cos(std::min(1.5, turn / 2)));
    EXPECT_LT(m.angle_rad, rounding) << turn;
    EXPECT_LT(m.distance_mm, 700 * rounding) << turn;
  }
}

TEST(CircleAxis, AParabolaOrAStraightLineHasNone) {
  BorderRun parabola, line;
  for (int i = 0; i <= 40; ++i) {
    const double x = 20.0 * (i - 20);
    parabola.points.emplace_back(x, 0, 0.002 * x * x);
    line.points.emplace_back(x, 1e-4 * (i % 2), 0);
  }
  for (BorderRun* run : {&parabola, &line}) {
    for (std::size_t i = 1; i < run->points.size(); ++i)
      run->length_mm += (run->points[i] - run->points[i - 1]).norm();
    EXPECT_FALSE(circle_axis(*run));
  }
}

TEST(RevolutionAxes, FindTheAxisOfAConeFromItsNormalsAlone) {
  const Eigen::Isometry3d placed = turned_about();
  const auto design = cone(placed, 0.9);
  const auto axes = revolution_axes(design.mesh, body_axes(design.mesh));
  ASSERT_FALSE(axes.empty());
  const Miss m = miss(axes.front(), placed * Vector3d::Zero(), placed.linear() * Vector3d::UnitZ());
  // A facet's normal lies in its cell's middle meridian, its centroid a sixth of the cell's width beside it:
  // lines miss the axis by up to 500 mm * 0.9 / 48 / 6 = 1.6 mm, to both sides alike.
  EXPECT_LT(m.distance_mm, 1.6);
  EXPECT_LT(m.angle_rad, 1.6 / 250);
  const auto fine = cone(placed, 0.9, 192, 32);
  const Miss f = miss(revolution_axes(fine.mesh, body_axes(fine.mesh)).front(), placed * Vector3d::Zero(),
                      placed.linear() * Vector3d::UnitZ());
  EXPECT_LT(f.distance_mm, 0.3 * m.distance_mm + 1e-6);
}

TEST(RevolutionAxes, OfAPatchOfASphereAreTheBodysOwn) {
  const auto sphere = [](const Eigen::Isometry3d& placed) {
    return grid_design("sphere", 40, 40, [&](double u, double v) -> Vector3d {
      const Vector3d d(u - 0.5, 0.6 * (v - 0.5), 1);
      return placed * (600 * d.normalized());
    });
  };
  const auto here = sphere(Eigen::Isometry3d::Identity()), there = sphere(turned_about());
  const auto a = revolution_axes(here.mesh, body_axes(here.mesh)),
             b = revolution_axes(there.mesh, body_axes(there.mesh));
  ASSERT_FALSE(a.empty());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Miss m = miss(b[i], turned_about() * a[i].point, turned_about().linear() * a[i].direction);
    EXPECT_LT(m.angle_rad, 1e-6);
    EXPECT_LT(m.distance_mm, 1e-3);
    // Through the centre, but for facets of 15 mm, whose normals' lines pass it by up to a third of that.
    EXPECT_LT(miss(a[i], Vector3d::Zero(), a[i].direction).distance_mm, 5);
  }
}

TEST(FanAxes, AConesCircularBordersHaveItsAxis) {
  const Eigen::Isometry3d placed = turned_about();
  for (const double turn : {0.3, 0.9, 2.5}) {
    const Miss m =
        nearest(axes_of(cone(placed, turn)), placed * Vector3d::Zero(), placed.linear() * Vector3d::UnitZ());
    EXPECT_LT(m.angle_rad, 1e-9) << turn;
    EXPECT_LT(m.distance_mm, 1e-6) << turn;
  }
}

TEST(FanAxes, AConesStraightBordersMeetInItsAxis) {
  // Cut off by waves instead of circles: only the straight borders and the normals tell.
  const Eigen::Isometry3d placed = turned_about();
  const double turn = 0.9;
  const auto design = grid_design("cut", 48, 8, [&](double u, double v) -> Vector3d {
    const double a = turn * u, out = 300 + 200 * v + 25 * (2 * v - 1) * std::sin(19 * u);
    return placed * Vector3d(out * std::cos(a), out * std::sin(a), 1.25 * (out - 300));
  });
  const Miss m = nearest(axes_of(design), placed * Vector3d::Zero(), placed.linear() * Vector3d::UnitZ());
  // The facets beside a border are turned from its meridian by half a cell, to opposite sides.
  const double half_cell = 0.5 * turn / 48;
  EXPECT_LT(m.angle_rad, 2 * half_cell);
  EXPECT_LT(m.distance_mm, 500 * 2 * half_cell);
}

TEST(FanAxes, PlaneEndsOfABendMeetInItsAxis) {
  const Eigen::Isometry3d placed = turned_about();
  const auto design = bend(placed);
  const Miss m = nearest(axes_of(design), placed * Vector3d::Zero(), placed.linear() * Vector3d::UnitZ());
  EXPECT_LT(m.angle_rad, 1e-9);
  EXPECT_LT(m.distance_mm, 1e-6);
}

TEST(FanAxes, TurnAndMoveWithTheDesign) {
  const auto here = bend(Eigen::Isometry3d::Identity()), there = bend(turned_about());
  const auto a = axes_of(here), b = axes_of(there);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_LT((turned_about() * a[i].point - b[i].point).norm(), 1e-5) << i;
    EXPECT_LT((turned_about().linear() * a[i].direction).cross(b[i].direction).norm(), 1e-8) << i;
  }
}

}  // namespace
}  // namespace hotblade::pipeline
