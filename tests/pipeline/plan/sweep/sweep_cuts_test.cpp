// Even parts of tubes, whole, trimmed and closed, against their angles.
#include "pipeline/plan/sweep/sweep_cuts.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/plan/plan.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 490, kLength = 500;

// Of `turn` rad about y, top at angle 0; at the far end the border runs askew, by so much of the turn.
surface::DesignSurface tube(double turn, double askew = 0) {
  return grid_design("tube", 180, 24, [=](double u, double v) -> Vector3d {
    const double angle = turn * ((1 - askew) * u + askew * v - 0.5);
    return {kRadius * std::sin(angle), kLength * v, kRadius * std::cos(angle)};
  });
}

// All the way round, `flare_mm` wider at its end.
surface::DesignSurface column(int around, int along, double radius_mm = kRadius, double length_mm = kLength,
                              double flare_mm = 0) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "column.obj";
  {
    std::ofstream out(file);
    out.precision(17);
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      for (int j = 0; j <= along; ++j) {
        const double v = static_cast<double>(j) / along, r = radius_mm + flare_mm * v * v;
        out << "v " << r * std::sin(angle) << " " << length_mm * v << " " << r * std::cos(angle) << "\n";
      }
    }
    for (int i = 0; i < around; ++i) {
      for (int j = 0; j < along; ++j) {
        const int a = i * (along + 1) + j + 1, c = (i + 1) % around * (along + 1) + j + 1;
        out << "f " << a << " " << c << " " << c + 1 << "\nf " << a << " " << c + 1 << " " << a + 1 << "\n";
      }
    }
  }
  return surface::read_obj(file, {"mm", 'z'});
}

RibAxes axes_of(const surface::DesignSurface& design) {
  return sweep_axes(waste_surface(design.mesh, 1), surface::parallel_about(design.mesh, Vector3d::UnitY()));
}

struct Arc {
  double from = 10, to = -10;
  std::size_t points = 0;
};

// What of the mesh lies behind each part's seams, by its angles about the tube's axis.
std::vector<Arc> arcs_of(const surface::TriangleMesh& mesh,
                         const std::vector<std::vector<SweepSeam>>& parts) {
  std::vector<Arc> arcs(parts.size());
  for (const Vector3d& p : mesh.vertices()) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (!std::all_of(parts[i].begin(), parts[i].end(),
                       [&](const SweepSeam& seam) { return seam.normal.dot(p) < seam.at_mm; }))
        continue;
      const double angle = std::atan2(p.x(), p.z());
      arcs[i].from = std::min(arcs[i].from, angle);
      arcs[i].to = std::max(arcs[i].to, angle);
      ++arcs[i].points;
    }
  }
  return arcs;
}

TEST(EvenLengths, OfATubeAreArcsAlike) {
  for (const double turn : {1.2, 2.5, 3.6, 4.3, 5.2}) {
    const surface::DesignSurface design = tube(turn);
    const RibAxes axes = axes_of(design);
    for (std::size_t parts = 2; parts <= 5; ++parts) {
      const auto arcs = arcs_of(design.mesh, even_lengths(design.mesh, axes, {-250, 250}, parts));
      ASSERT_EQ(arcs.size(), parts);
      // Facets of a hundred and eightieth of the turn end at the seams' next corners.
      const double facet = turn / 180;
      for (const Arc& arc : arcs)
        EXPECT_NEAR(arc.to - arc.from, turn / static_cast<double>(parts), 2 * facet) << turn << " " << parts;
      EXPECT_NEAR(arcs.front().from,
                  axes.x.x() > 0 ? -turn / 2 : turn / 2 - turn / static_cast<double>(parts), 2 * facet);
    }
  }
}

// The longest section ends where others go on.
TEST(EvenLengths, OfATrimmedTubeGoOnPastItsLongestSection) {
  const double turn = 4, askew = 0.4;
  const surface::DesignSurface design = tube(turn, askew);
  const auto arcs = arcs_of(design.mesh, even_lengths(design.mesh, axes_of(design), {-250, 250}, 4));
  ASSERT_EQ(arcs.size(), 4U);
  // Sections in the middle of eight of the length are met: the border goes on for a sixteenth of the askew.
  const double missed = askew * turn / 16;
  for (const Arc& arc : arcs) EXPECT_NEAR(arc.to - arc.from, turn / 4, missed + 0.05);
}

TEST(EvenLengths, OfAClosedTubeGoAllTheWayRound) {
  constexpr int kAround = 180, kAlong = 24;
  const surface::DesignSurface design = column(kAround, kAlong);
  const auto parts = even_lengths(design.mesh, axes_of(design), {-250, 250}, 4);
  ASSERT_EQ(parts.size(), 4U);
  // A quarter of the corners each, but for those that a seam meets.
  for (const Arc& arc : arcs_of(design.mesh, parts))
    EXPECT_NEAR(static_cast<double>(arc.points), kAround / 4.0 * (kAlong + 1), 2 * (kAlong + 1));
}

TEST(EvenLengths, CutColumnsIntoFour) {
  for (const double flare : {0.0, 60.0}) {
    const PlanResult result = plan(column(80, 50, 150, 800, flare), back_kept(), {});
    EXPECT_EQ(result.program.verification.status, VerificationStatus::kPassed) << flare;
    EXPECT_LE(result.strips.size(), 4U) << flare;
  }
}

TEST(EvenLengths, OfAFlatPanelAreItsWidths) {
  const surface::DesignSurface design = grid_design("flat", 40, 20, [](double u, double v) -> Vector3d {
    return {600 * u - 300, 500 * v, 0};
  });
  const RibAxes axes = axes_of(design);
  const auto lengths = even_lengths(design.mesh, axes, {-250, 250}, 3);
  const auto widths = even_widths(axes, 0, {-300, 300}, 3);
  ASSERT_EQ(lengths.size(), 3U);
  // Beyond those of even widths the outer parts end at the middle, which they do not reach.
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < widths[i].size(); ++k) {
      EXPECT_LT((lengths[i][k].normal - widths[i][k].normal).norm(), 1e-9);
      EXPECT_NEAR(lengths[i][k].at_mm, widths[i][k].at_mm, 1e-6);
    }
  }
}

TEST(EvenLengths, OfPlanesThatMissTheMeshAreNone) {
  const surface::DesignSurface design = tube(2);
  EXPECT_TRUE(even_lengths(design.mesh, axes_of(design), {2000, 2500}, 3).empty());
}

}  // namespace
}  // namespace hotblade::pipeline
