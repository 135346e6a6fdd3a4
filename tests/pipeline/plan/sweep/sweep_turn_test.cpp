// What a fit says of turning its planes, against fits in turned planes.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "elastica/curve/elastica.hpp"
#include "pipeline/plan/sweep/sweep_fit.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Elastica in the planes y = const that change from one side's bend to the other's: followed there by one
// family, and nowhere else.
Vector3d elasticas(double u, double v) {
  const elastica::Elastica blade{0, 0, 0, 0.006 * (v - 0.5), 1e-5, 2e-5 * (1 - 2 * v), 1};
  const Vector2d q = elastica::point_at(blade, 500 * (u - 0.5)).position();
  return Eigen::AngleAxisd(0.3 * v * v, Vector3d::UnitY()) * Vector3d(q.x(), 0, q.y()) +
         Vector3d(0, 500 * v, 60 * v * v);
}

struct Planes {
  Planes() : design(grid_design("elasticas", 80, 80, elasticas)), surface(waste_surface(design.mesh, 1)) {}

  // The fit in planes turned by rad about x and y of others' axes.
  SweepFitReport fit(const RibAxes& axes, const std::vector<int>& exponents) const {
    SweepSectionOptions sections;
    sections.kerf_mm = sections.width_mm = 1e-3;  // the blade's middle runs on the surface
    SweepFitOptions options;
    options.exponents = exponents;
    options.blade_length_mm = 560;
    options.largest_turn_rad = 3;  // no limit pulls
    options.turn_planes = true;
    return fit_sweep(sweep_sections(surface, axes, sections), options);
  }
  RibAxes axes(const Vector3d& normal) const {
    return sweep_axes(surface, surface::parallel_about(design.mesh, normal.normalized()));
  }
  RibAxes turned(const RibAxes& from, const Vector2d& turn) const {
    return axes(from.sweep - turn.x() * from.y + turn.y() * from.x);
  }

  surface::DesignSurface design;
  WasteSurface surface;
};

double mean(const SweepFitReport& fit) {
  return fit.rms_mm * fit.rms_mm;
}

TEST(PlaneTurn, HasTheSlopeOfTheMeanOverFitsInTurnedPlanes) {
  const Planes planes;
  const RibAxes axes = planes.axes({0.06, 1, -0.08});
  const SweepFitReport fit = planes.fit(axes, {2});
  constexpr double kStep = 4e-3;
  for (const Vector2d& axis : {Vector2d(1, 0), Vector2d(0, 1), Vector2d(0.6, -0.8)}) {
    const double high = mean(planes.fit(planes.turned(axes, kStep * axis), {2})),
                 low = mean(planes.fit(planes.turned(axes, -kStep * axis), {2}));
    const double slope = fit.turn.gradient.dot(axis);
    EXPECT_NEAR(slope, (high - low) / (2 * kStep), 0.1 * fit.turn.gradient.norm()) << axis.transpose();
  }
  EXPECT_GT(fit.turn.gradient.norm(), 1e-3);
}

TEST(PlaneTurn, LeadsToThePlanesOfASweptElastica) {
  const Planes planes;
  RibAxes axes = planes.axes({0.06, 1, -0.08});
  SweepFitReport fit = planes.fit(axes, {2});
  const double first_mm = fit.max_mm, first_rad = axes.sweep.cross(Vector3d::UnitY()).norm();
  for (int look = 0; look < 4; ++look) {
    axes = planes.turned(axes, -fit.turn.matrix.ldlt().solve(fit.turn.gradient));
    fit = planes.fit(axes, {2});
  }
  EXPECT_GT(first_mm, 0.3);
  EXPECT_LT(fit.max_mm, 0.1 * first_mm);
  EXPECT_LT(axes.sweep.cross(Vector3d::UnitY()).norm(), 0.1 * first_rad);
}

TEST(PlaneTurn, AtAnotherScaleIsThatOfTheSameMean) {
  PlaneTurn turn;
  turn.gradient = {1, -2};
  turn.matrix << 3, 1, 1, 4;
  turn.exponent = 8;
  turn.scale_mm = 0.5;
  // A distance d counts as d^2 (d / scale)^6.
  const PlaneTurn other = turn.at_scale(1);
  EXPECT_NEAR(other.gradient.x(), std::pow(0.5, 6), 1e-15);
  EXPECT_NEAR(other.matrix(1, 1), 4 * std::pow(0.5, 6), 1e-15);
  EXPECT_EQ(other.scale_mm, 1);
}

}  // namespace
}  // namespace hotblade::pipeline
