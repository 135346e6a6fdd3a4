#include "pipeline/plan/direction/body_axes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

surface::DesignSurface arch(const Eigen::Isometry3d& placed, double length, int nu = 20, int nv = 24) {
  return grid_design("arch", nu, nv, [&](double u, double v) -> Eigen::Vector3d {
    const double y = 400 * (v - 0.5);
    return placed * Eigen::Vector3d(length * u, y, 100 - 0.001 * y * y + 30 * u * u);
  });
}

Eigen::Isometry3d placement() {
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  t.rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -0.5).normalized()));
  t.translation() = Eigen::Vector3d(300, -4000, 1200);
  return t;
}

TEST(BodyAxes, TurnWithTheDesign) {
  for (const double length : {900.0, 400.0}) {
    const Eigen::Isometry3d placed = placement();
    const auto here = arch(Eigen::Isometry3d::Identity(), length), there = arch(placed, length);
    const BodyAxes a = body_axes(here.mesh), b = body_axes(there.mesh);
    EXPECT_LT((placed * a.centre - b.centre).norm(), 1e-9);
    for (const Eigen::Vector3d& n : hemisphere(a)) {
      double nearest = 0;
      const Eigen::Vector3d turned = placed.linear() * with_sense(here.mesh, a, n);
      for (const Eigen::Vector3d& m : hemisphere(b)) {
        nearest = std::max(nearest, turned.dot(with_sense(there.mesh, b, m)));
      }
      EXPECT_GT(nearest, 1 - 1e-9);
    }
  }
}

TEST(BodyAxes, DoNotDependOnHowTheSurfaceIsMeshed) {
  const auto coarse = arch(placement(), 900, 40, 48), fine = arch(placement(), 900, 73, 101);
  const BodyAxes a = body_axes(coarse.mesh), b = body_axes(fine.mesh);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(std::abs(a.axes[i].dot(b.axes[i])), 1 - 1e-6);
}

TEST(BodyAxes, KeepTheirDigitsFarFromTheOrigin) {
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation() = Eigen::Vector3d(1e6, -1e6, 1e6);
  const BodyAxes a = body_axes(arch(Eigen::Isometry3d::Identity(), 900).mesh),
                 b = body_axes(arch(far, 900).mesh);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(std::abs(a.axes[i].dot(b.axes[i])), 1 - 1e-14);
}

TEST(AlongBorders, FindsThePlanesOfStraightBorders) {
  const Eigen::Isometry3d placed = placement();
  const auto design = arch(placed, 900);
  const auto directions = along_borders(design.mesh, body_axes(design.mesh));
  ASSERT_EQ(directions.size(), 2u);
  const Eigen::Vector3d x = placed.linear().col(0), y = placed.linear().col(1);
  // The long borders first; the arch's body is tilted by a degree or two about y.
  EXPECT_GT(std::abs(directions[0].dot(y)), 1 - 1e-9);
  EXPECT_GT(std::abs(directions[1].dot(x)), 0.999);
}

TEST(Hemisphere, LeavesNoDirectionFartherThanThirtyDegrees) {
  const BodyAxes body{{0, 0, 0},
                      {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}};
  const auto all = hemisphere(body);
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j <= 30; ++j) {
      const double a = 0.1047 * i, up = 1.5708 * j / 30;
      const Eigen::Vector3d d(std::cos(a) * std::cos(up), std::sin(a) * std::cos(up), std::sin(up));
      double nearest = 0;
      for (const Eigen::Vector3d& n : all) nearest = std::max(nearest, std::abs(n.dot(d)));
      EXPECT_GT(nearest, std::cos(30.1 * 3.14159265 / 180)) << a << " " << up;
    }
  }
}

}  // namespace
}  // namespace hotblade::pipeline
