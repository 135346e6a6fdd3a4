#include "pipeline/verify/verify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "pipeline/plan/plan.hpp"
#include "pipeline/verify/swept_surface.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

const PlanResult& cylinder_plan() {
  static const PlanResult result = plan(cylinder_design(), along_x(), {});
  return result;
}

TEST(SweptSurface, OfACylinderPlanIsTheCylinder) {
  const SweptSurface cut = swept_surface(cylinder_plan().program);
  ASSERT_GT(cut.vertices.size(), 1000u);
  for (std::size_t i = 0; i < cut.vertices.size(); ++i) {
    const Eigen::Vector3d& p = cut.vertices[i];
    // The mesh's chords lie 1e-3 mm under the cylinder.
    EXPECT_NEAR(std::hypot(p.y(), p.z()), 400, 0.01);
    EXPECT_NEAR(cut.normals[i].dot(Eigen::Vector3d(0, p.y(), p.z()) / 400), 1, 1e-3);
  }
}

TEST(SweptSurface, FacesTheWaste) {
  const SweptSurface cut = swept_surface(cylinder_plan().program);
  for (const auto& t : cut.triangles) {
    const auto at = [&](std::size_t i) { return cut.vertices[static_cast<std::size_t>(t[i])]; };
    EXPECT_GT((at(1) - at(0)).cross(at(2) - at(0)).dot(cut.normals[static_cast<std::size_t>(t[0])]), 0);
  }
}

TEST(SweptSurface, AMicrometreAtTheEndDoesNotTiltIt) {
  Program program = cylinder_plan().program;
  std::vector<BladePose>& poses = program.strips[0].poses;
  const auto last = std::find_if(poses.rbegin(), poses.rend(), [](const BladePose& p) { return p.foam; });
  ASSERT_NE(last, poses.rend());
  // A hundredth of a millimetre on along the sweep, and one off: what registers and a log's rate make of an
  // end.
  BladePose pose = *last;
  pose.frame.origin += 1e-2 * Eigen::Vector3d::UnitX() + 1e-3 * Eigen::Vector3d::UnitZ();
  pose.t += 1e-3;
  poses.insert(last.base(), pose);
  double reach = 0, sag = 0;
  for (const StripFacts& f : cylinder_plan().strips) sag = std::max(sag, f.motion.droop_mm);
  const SweptSurface cut = swept_surface(program);
  for (std::size_t i = 0; i < cut.vertices.size(); ++i) {
    // A micrometre over half a sample of 2.5 mm, and the facets' own slope.
    EXPECT_LT(std::abs(cut.normals[i].x()), 2e-3);
    reach = std::max(reach, cut.vertices[i].x());
  }
  EXPECT_NEAR(reach, pose.frame.origin.x(), 1e-2 + sag);
}

surface::DesignSurface with_vertices(surface::DesignSurface design,
                                     const std::function<void(Eigen::Vector3d&)>& move) {
  surface::TriangleSoup soup = design.mesh.soup();
  for (Eigen::Vector3d& p : soup.vertices) move(p);
  design.mesh = surface::TriangleMesh(std::move(soup));
  return design;
}

TEST(Verify, MeasuresADesignMovedAway) {
  for (const double by : {0.2, 0.7, 1.4}) {
    const surface::DesignSurface moved =
        with_vertices(cylinder_design(), [&](Eigen::Vector3d& p) { p *= (400 + by) / 400; });
    const VerifyReport report = verify(cylinder_plan().program, moved, {});
    EXPECT_NEAR(report.deviation.p99, by, 0.03);
    // At the straight edges the scaled design also moves sideways, by 0.3 of the shift.
    EXPECT_GT(report.deviation.max, by - 0.03);
    EXPECT_LT(report.deviation.max, 1.25 * by + 0.1);
    EXPECT_EQ(report.within_tolerance, by < 1);
  }
}

TEST(Verify, MeasuresADentWhereItIs) {
  const Eigen::Vector3d place(150, 0, 400);
  const surface::DesignSurface dented = with_vertices(cylinder_design(), [&](Eigen::Vector3d& p) {
    if ((p - place).norm() < 8) p.z() -= 1.7;
  });
  const VerifyReport report = verify(cylinder_plan().program, dented, {});
  EXPECT_NEAR(report.deviation.max, 1.7, 0.1);
  EXPECT_LT(std::abs(report.deviation.at.x() - 150), 90);
  EXPECT_FALSE(report.within_tolerance);
}

// A dent, a design moved away, strips side by side with a gap between: where a dense grid finds the largest
// deviation the bound holds it, however few samples lie there.
TEST(Verify, SettlesWhatADenseGridFinds) {
  const surface::DesignSurface plain = cylinder_design();
  const auto dented = [&](double depth_mm, double wide_mm) {
    // A mesh as fine as the dent: what lies between its vertices is flat.
    surface::DesignSurface design = grid_design("dented", 100, 100, [&](double u, double v) {
      const double phi = 0.6 * (v - 0.5);
      Eigen::Vector3d p(300 * u, 400 * std::sin(phi), 400 * std::cos(phi));
      const double r = (p - Eigen::Vector3d(151, 3, 400)).norm() / wide_mm;
      p.z() -= depth_mm * std::exp(-r * r);
      return p;
    });
    return design;
  };
  Program gapped = cylinder_plan().program;
  const Strip whole = gapped.strips.at(0);
  gapped.strips.clear();
  for (const double from : {0.0, 0.4, 0.7}) {
    Strip part = whole;
    part.id = "part" + std::to_string(gapped.strips.size());
    for (BladePose& pose : part.poses) {
      if (!pose.foam) continue;
      const auto [s0, s1] = *pose.foam;
      pose.foam = {{s0 + (from + (from > 0.5 ? 0.02 : 0)) * (s1 - s0), s0 + (from + 0.3) * (s1 - s0)}};
    }
    gapped.strips.push_back(part);
  }
  struct Case {
    surface::DesignSurface design;
    const Program& program;
  };
  const Program& planned = cylinder_plan().program;
  for (const Case& c : {Case{plain, planned}, Case{dented(0.4, 12), planned}, Case{dented(0.9, 60), planned},
                        Case{plain, gapped}}) {
    VerifyOptions dense;
    dense.sample_mm = dense.widest = 1;
    const VerifyReport report = measure(c.program, {}, c.design, {}),
                       densely = measure(c.program, {}, c.design, dense);
    EXPECT_LE(densely.deviation.max, report.bound_mm);
    EXPECT_NEAR(report.deviation.max, densely.deviation.max, 0.02);
    EXPECT_LE(report.bound_mm, densely.deviation.max + 0.03);
    EXPECT_NEAR(report.deviation.rms, densely.deviation.rms, 0.02);
    EXPECT_NEAR(report.uncut_mm2, densely.uncut_mm2, 2e-3 * report.area_mm2);
    EXPECT_LT(4 * (report.cut_samples + report.design_samples), densely.cut_samples + densely.design_samples);
    // Where something is left uncut, its edge decides.
    for (std::size_t i = 0; i < c.program.strips.size() && densely.uncut_mm2 == 0; ++i)
      EXPECT_LE(densely.strip_max_mm[i], report.strip_bound_mm[i] + 0.01);
  }
}

// A corner of large facets stands out between the samples of a cut, however far apart these lie.
TEST(Verify, OfTheCutAloneMeetsCornersOfLargeFacets) {
  const surface::DesignSurface coarse = grid_design("coarse", 11, 9, [](double u, double v) {
    const double phi = 0.6 * (v - 0.5);
    return Eigen::Vector3d(300 * u, 400 * std::sin(phi), 400 * std::cos(phi));
  });
  const std::span<const Eigen::Vector3d> all = coarse.mesh.vertices();
  const auto nearest = [&](const Eigen::Vector3d& to) -> Eigen::Vector3d {
    return *std::min_element(all.begin(), all.end(),
                             [&](const auto& p, const auto& q) { return (p - to).norm() < (q - to).norm(); });
  };
  for (const double x : {100.0, 130.0, 190.0}) {
    const Eigen::Vector3d corner = nearest({x, 30, 400});
    const surface::DesignSurface raised = with_vertices(coarse, [&](Eigen::Vector3d& p) {
      if (p == corner) p *= 1 + 0.9 / 400;
    });
    VerifyOptions far_apart;
    far_apart.sample_mm = 7;
    far_apart.cut_only = true;
    const VerifyReport report = measure(cylinder_plan().program, {}, raised, far_apart);
    EXPECT_NEAR(report.deviation.max, 0.9, 0.01) << x;
    EXPECT_NEAR(report.strip_max_mm.at(0), 0.9, 0.01) << x;
    EXPECT_LT((report.strip_max_at.at(0) - corner).norm(), 1) << x;
    EXPECT_EQ(report.uncut_mm2, 0);
  }
}

TEST(Verify, CountsWhatNoStripReachesAsUncutArea) {
  // Half as long again: the last 150 mm are not cut, but for what the blade goes on past the end of the
  // design that it was planned for, and the reach of three tolerances.
  const surface::DesignSurface longer = grid_design("longer", 45, 120, [](double u, double v) {
    const double phi = 0.6 * (v - 0.5);
    return Eigen::Vector3d(450 * u, 400 * std::sin(phi), 400 * std::cos(phi));
  });
  const Program& program = cylinder_plan().program;
  double end = 0;
  for (const BladePose& pose : program.strips[0].poses) {
    if (pose.foam) end = std::max(end, pose.frame.origin.x());
  }
  EXPECT_LT(end, 305);
  const VerifyReport report = verify(program, longer, {});
  EXPECT_NEAR(report.uncut_share(), (450 - end - 3.0) / 450, 0.003);
  EXPECT_FALSE(report.within_tolerance);
}

TEST(Verify, SeesClampsThatDoNotHoldThePlannedBlade) {
  Program program = cylinder_plan().program;
  EXPECT_LT(verify(program, cylinder_design(), {}).clamp_mismatch_mm, 1e-6);
  program.strips[0].poses[300].b.p.x() += 0.5;
  const VerifyReport report = verify(program, cylinder_design(), {});
  EXPECT_NEAR(report.clamp_mismatch_mm, 0.5, 1e-6);
  EXPECT_FALSE(report.within_tolerance);
}

TEST(Verify, SeesAFinBetweenTheRibsThatIsCutOff) {
  // A fin 20 mm tall stands between two rib planes: the cut runs below it, well inside its own edges.
  surface::DesignSurface fin = cylinder_design();
  const Eigen::Vector3d a(149, -20, 399.5), b(149, 20, 399.5), up(0, 0, 20);
  surface::TriangleSoup soup = fin.mesh.soup();
  const int base = static_cast<int>(soup.vertices.size());
  for (const Eigen::Vector3d& p : {a, b, Eigen::Vector3d(b + up), Eigen::Vector3d(a + up)}) {
    soup.vertices.push_back(p);
  }
  soup.triangles.push_back({base, base + 1, base + 2});
  soup.triangles.push_back({base, base + 2, base + 3});
  fin.mesh = surface::TriangleMesh(std::move(soup));
  const VerifyReport report = verify(cylinder_plan().program, fin, {});
  EXPECT_GT(report.deviation.max, 15);
  EXPECT_FALSE(report.within_tolerance);
}

TEST(Verify, SamplesNeedlesInProportionToTheirLength) {
  // 300 mm long, 0.4 mm wide: an even subdivision of each would make 17 million.
  const surface::DesignSurface needles = grid_design("needles", 1, 600, [](double u, double v) {
    const double phi = 0.6 * (v - 0.5);
    return Eigen::Vector3d(300 * u, 400 * std::sin(phi), 400 * std::cos(phi));
  });
  const VerifyReport report = verify(cylinder_plan().program, needles, {});
  EXPECT_LT(report.design_samples, 300000u);
  EXPECT_GT(report.design_samples, 10000u);
  EXPECT_TRUE(report.within_tolerance);
}

TEST(Verify, OfAProgramWithoutStripsLeavesEverythingUncut) {
  const VerifyReport report = verify(Program{}, cylinder_design(), {});
  EXPECT_EQ(report.uncut_share(), 1);
  EXPECT_FALSE(report.within_tolerance);
}

}  // namespace
}  // namespace hotblade::pipeline
