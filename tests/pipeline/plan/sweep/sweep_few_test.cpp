// First looks at a dense design: few of its points, which stand for all.
#include "pipeline/plan/sweep/sweep_few.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/plan/plan.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kSwellMm = 900, kCellMm = 12;
constexpr int kFine = 240;

Vector3d swell(double u, double v) {
  return {kSwellMm * u, 0.7 * kSwellMm * v, 60 * std::sin(3 * u) * std::cos(4 * v)};
}

surface::DesignSurface swell_in_facets(int facets) {
  return grid_design("swell", facets, facets, swell);
}

surface::DesignSurface moved(const surface::DesignSurface& design, const Eigen::Isometry3d& motion) {
  surface::DesignSurface other = design;
  surface::TriangleSoup soup = design.mesh.soup();
  for (Vector3d& v : soup.vertices) v = motion * v;
  other.mesh = surface::TriangleMesh(std::move(soup));
  return other;
}

std::shared_ptr<const WasteSurface> few_of_design(const surface::DesignSurface& design) {
  return few_of(waste_surface(design.mesh, 1), design.mesh, kCellMm);
}

TEST(SweepFew, AreOnTheDesignAndNoPlaceIsFarFromTheirTriangles) {
  const surface::DesignSurface design = swell_in_facets(kFine);
  const auto few = few_of_design(design);
  ASSERT_TRUE(few);
  EXPECT_LT(8 * few->triangles.size(), design.mesh.triangles().size());
  const gpu::MeshDistance to_few(few->points, few->triangles);
  double farthest = 0, inside = 0;
  const auto vertices = design.mesh.vertices();
  const std::vector<gpu::Nearest> nearest = to_few.query(vertices);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vector3d& p = vertices[i];
    const double to_border = std::min({p.x(), p.y(), kSwellMm - p.x(), 0.7 * kSwellMm - p.y()});
    farthest = std::max(farthest, nearest[i].distance);
    if (to_border > 2 * kCellMm) inside = std::max(inside, nearest[i].distance);
  }
  // The swell bends to 100 mm; over two cells an arc of that rises by their square over 8 radii. A line of
  // the grid may cut off a corner.
  EXPECT_LT(inside, 4 * kCellMm * kCellMm / (8 * 100));
  EXPECT_LT(farthest, kCellMm);
  const gpu::MeshDistance to_design(design.mesh.vertices(), design.mesh.triangles());
  for (const gpu::Nearest& n : to_design.query(few->points)) ASSERT_LT(n.distance, 1e-9);
}

TEST(SweepFew, KeepTheBorder) {
  const auto few = few_of_design(swell_in_facets(kFine));
  ASSERT_TRUE(few);
  EXPECT_GE(few->corners.size(), 2u);
  Eigen::AlignedBox2d box;
  double length = 0;
  for (const auto& [a, b] : few->border) {
    const Vector3d &p = few->points[static_cast<std::size_t>(a)],
                   &q = few->points[static_cast<std::size_t>(b)];
    for (const Vector3d& at : {p, q}) box.extend(Eigen::Vector2d(at.x(), at.y()));
    length += (q - p).head<2>().norm();
  }
  EXPECT_NEAR(box.sizes().x(), kSwellMm, 1e-9);
  EXPECT_NEAR(box.sizes().y(), 0.7 * kSwellMm, 1e-9);
  EXPECT_NEAR(length, 2 * 1.7 * kSwellMm, 4 * kCellMm);
}

TEST(SweepFew, AreTheSameHoweverTheDesignLies) {
  const surface::DesignSurface design = swell_in_facets(kFine);
  Eigen::Isometry3d motion(Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.4).normalized()));
  motion.pretranslate(Vector3d(3000, -500, 70));
  const auto here = few_of_design(design), there = few_of_design(moved(design, motion));
  ASSERT_TRUE(here && there);
  // Rounding may put a point into the next cell.
  std::size_t same = 0;
  const gpu::MeshDistance to_there(there->points, there->triangles);
  for (const Vector3d& p : here->points) {
    const Vector3d q = motion * p;
    same += std::any_of(there->points.begin(), there->points.end(),
                        [&](const Vector3d& r) { return (r - q).norm() < 1e-6; })
                ? 1
                : 0;
  }
  EXPECT_GT(same, here->points.size() * 99 / 100);
  EXPECT_NEAR(static_cast<double>(there->triangles.size()), static_cast<double>(here->triangles.size()),
              0.01 * static_cast<double>(here->triangles.size()));
}

TEST(SweepFew, AreNotTakenOfADesignThatHasFew) {
  EXPECT_FALSE(few_of_design(swell_in_facets(40)));
  const surface::DesignSurface dense = swell_in_facets(kFine);
  EXPECT_FALSE(few_of(waste_surface(dense.mesh, 1), dense.mesh, 4));
}

// What is planned by few points is measured against all.
TEST(SweepFew, PlanADenseDesignAsItIsPlannedInFewFacets) {
  const Settings settings = back_kept();
  const auto gentle = [](double u, double v) -> Vector3d {
    return {700 * u, 500 * v, 40 * std::sin(2 * u) + 25 * v * v};
  };
  const PlanResult sparse = plan(grid_design("gentle", 60, 60, gentle), settings, {}),
                   dense = plan(grid_design("gentle", 180, 180, gentle), settings, {});
  EXPECT_TRUE(dense.refusals.empty());
  EXPECT_EQ(dense.program.strips.size(), sparse.program.strips.size());
  EXPECT_NEAR(dense.verification.deviation.max, sparse.verification.deviation.max, 0.1);
}

}  // namespace
}  // namespace hotblade::pipeline
