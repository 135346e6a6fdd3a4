// Where a wide blade has to pass to leave a design that bends, against all places of its width by themselves.
#include "pipeline/plan/sweep/moved_surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHalfTurn_rad = 0.6, kWidth_mm = 8, kKerf_mm = 1;
constexpr int kFacets = 200;

// Where blades pass that sweep along x across a part of a cylinder about y, hollow or a crest seen from the
// waste above it, its middle leaning, or about an axis so far below: of each vertex its place in x and z, the
// blade's middle and the direction of its width.
struct Passed {
  std::vector<Vector2d> design, middles, widths;
};

Passed passed(double radius_mm, bool hollow, double lean_rad, double axis_mm) {
  const Eigen::AngleAxisd lean(lean_rad, Vector3d::UnitY());
  const surface::DesignSurface design =
      grid_design("cylinder", kFacets, 8, [&](double u, double v) -> Vector3d {
        const double angle = kHalfTurn_rad * (2 * u - 1), side = hollow ? -1 : 1;
        return lean *
               Vector3d(radius_mm * std::sin(angle), 100 * v, side * radius_mm * (std::cos(angle) - 1));
      });
  const surface::PlaneFamily planes =
      axis_mm == 0 ? surface::parallel_about(design.mesh, Vector3d::UnitX())
                   : surface::fan_about(design.mesh, {{0, 0, -axis_mm}, Vector3d::UnitY()});
  WasteSurface surface = waste_surface(design.mesh, 1);
  if (surface.normals.front().z() < 0) surface = waste_surface(design.mesh, -1);
  SweepSectionOptions options;
  options.kerf_mm = kKerf_mm;
  options.width_mm = kWidth_mm;
  const MovedSurface moved(surface, sweep_axes(surface, planes), options);
  Passed all;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Vector3d &p = surface.points[i], &q = moved.vertex(static_cast<int>(i)).world;
    if (std::abs(p.y() - 50) > 1) continue;
    all.design.emplace_back(p.x(), p.z());
    all.middles.emplace_back(q.x(), q.z());
    const Vector3d width = planes.normal_at(q);
    all.widths.emplace_back(width.x(), width.z());
  }
  return all;
}

// Distance of a point from what the width's middle surface passes through on its way along these places.
double distance_mm(const Passed& all, const Vector2d& p) {
  constexpr int kPieces = 50;
  double nearest = 1e300;
  for (std::size_t i = 0; i + 1 < all.middles.size(); ++i) {
    if ((all.middles[i] - p).norm() > 3 * kWidth_mm) continue;
    for (int k = 0; k <= kPieces; ++k) {
      const double t = static_cast<double>(k) / kPieces;
      const Vector2d m = all.middles[i] + t * (all.middles[i + 1] - all.middles[i]);
      const Vector2d width = (all.widths[i] + t * (all.widths[i + 1] - all.widths[i])).normalized();
      const double along = std::clamp((p - m).dot(width), -kWidth_mm / 2, kWidth_mm / 2);
      nearest = std::min(nearest, (p - m - along * width).norm());
    }
  }
  return nearest;
}

TEST(MovedSurface, IsWhereAWideBladeTouchesTheDesign) {
  for (const double radius_mm : {40.0, 142.0, 500.0}) {
    const double second_order_mm = kWidth_mm * kWidth_mm / (8 * radius_mm),
                 facet_mm = 2 * kHalfTurn_rad * radius_mm / kFacets;
    const double most_mm = 0.06 * second_order_mm + facet_mm * facet_mm / (8 * radius_mm);
    for (const double lean_rad : {0.0, 0.4}) {
      for (const double axis_mm : {0.0, -300.0, 600.0}) {
        for (const bool hollow : {false, true}) {
          const Passed all = passed(radius_mm, hollow, lean_rad, axis_mm);
          double left = 0, gouged = 0;
          for (std::size_t i = 0; i < all.design.size(); ++i) {
            const Vector2d& p = all.design[i];
            if ((p - all.design.front()).norm() < 3 * kWidth_mm ||
                (p - all.design.back()).norm() < 3 * kWidth_mm)
              continue;
            const double off = distance_mm(all, p) - 0.5 * kKerf_mm;
            // Where the width lies level over a hollow's ground no blade comes to it.
            const Vector2d tangent = (all.design[i + 1] - all.design[i - 1]).normalized();
            const double slope = std::abs(tangent.x() * all.widths[i].y() - tangent.y() * all.widths[i].x());
            const double bends_per_mm = 1 / radius_mm + (axis_mm == 0 ? 0 : 1 / std::abs(axis_mm));
            const bool ground = hollow && slope < (kWidth_mm / 2 + facet_mm) * bends_per_mm;
            if (!ground) left = std::max(left, off);
            gouged = std::max(gouged, -off);
          }
          // By the slope alone each is as much as the second order.
          EXPECT_LT(left, most_mm) << radius_mm << " " << hollow << " " << lean_rad << " " << axis_mm;
          EXPECT_LT(gouged, most_mm) << radius_mm << " " << hollow << " " << lean_rad << " " << axis_mm;
        }
      }
    }
  }
}

}  // namespace
}  // namespace hotblade::pipeline
