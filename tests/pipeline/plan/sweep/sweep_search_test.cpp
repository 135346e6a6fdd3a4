// Sections of moved surfaces, and whole swept plans measured again by code that shares nothing with the fit.
#include "pipeline/plan/sweep/sweep_search.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "elastica/curve/elastica.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/plan/ribs/rib_spline.hpp"
#include "pipeline/plan/sweep/sweep_sections.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A twisted patch whose corners are oblique to any planes.
Vector3d patch(double u, double v) {
  const double x = 620 * u + 60 * v, y = 480 * v + 50 * u * u;
  return {x, y, 60 * std::sin(2.2 * u + 0.4) * (1 + v) + 45 * v * v - 30 * u * v};
}

surface::DesignSurface patch_design(const Eigen::Isometry3d& turn = Eigen::Isometry3d::Identity()) {
  return grid_design("patch", 48, 40, [&](double u, double v) -> Vector3d { return turn * patch(u, v); });
}

SweptPlan first_plan(const surface::DesignSurface& design, const Settings& settings) {
  SweptPlan found;
  const auto judge = [&](const SweptPlan& plan) -> SweepVerdict {
    found = plan;
    return {plan.refusals.empty(), {}};
  };
  search_sweeps(design, settings, {judge, judge});
  return found;
}

TEST(SweepSections, OfASphereAreThoseOfALargerSphere) {
  // Square to the planes' normal the band is the kerf's; elsewhere the sphere is moved by more.
  const surface::DesignSurface design = grid_design("sphere", 60, 60, [](double u, double v) -> Vector3d {
    const double a = 0.8 * (u - 0.5), b = 0.8 * (v - 0.5);
    return 500 * Vector3d(std::sin(a), std::cos(a) * std::sin(b), std::cos(a) * std::cos(b));
  });
  const WasteSurface surface = waste_surface(design.mesh, 1);
  const RibAxes axes = sweep_axes(surface, surface::PlaneFamily::parallel(Vector3d::UnitX()));
  EXPECT_LT((axes.x.cross(axes.y) - axes.sweep).norm(), 1e-12);
  const SweepData data = sweep_sections(surface, axes, {1, 8, 20, 20, {}, {}});
  ASSERT_GT(data.sections.size(), 15U);
  for (const SweepSection& section : data.sections) {
    // A point at angle a lies at (500 + half a band) sin a along the sweep.
    double a = std::asin(section.offset_mm / 500);
    for (int i = 0; i < 50; ++i)
      a = std::asin(section.offset_mm / (500 + 0.5 * (1 + 8 * std::abs(std::sin(a)))));
    const double radius = (500 + 0.5 * (1 + 8 * std::abs(std::sin(a)))) * std::cos(a);
    // A border vertex has the normal of half a cell inwards, 0.007 rad off: 4 mm of half a band times that.
    for (const SweepSample& sample : section.samples) {
      EXPECT_NEAR(sample.q.norm(), radius, 0.06) << section.offset_mm;
      EXPECT_NEAR(sample.cosine, std::cos(a), 5e-3);
    }
  }
}

TEST(SweepSections, KeepBehindTheirSeams) {
  const surface::DesignSurface design = patch_design();
  const WasteSurface surface = waste_surface(design.mesh, 1);
  const RibAxes axes = sweep_axes(surface, surface::PlaneFamily::parallel(Vector3d::UnitX()));
  SweepSectionOptions options;
  options.seams = {{-Vector3d::UnitX(), -100}, {Vector3d::UnitX(), 300}, {axes.x, 250}};
  const SweepData data = sweep_sections(surface, axes, options);
  EXPECT_TRUE(data.seam_first);
  EXPECT_TRUE(data.seam_last);
  ASSERT_FALSE(data.sections.empty());
  for (const SweepSection& section : data.sections) {
    EXPECT_GE(section.offset_mm, 100);
    EXPECT_LE(section.offset_mm, 300);
    for (const SweepSample& sample : section.samples) EXPECT_LE(sample.q.x(), 250 + 1e-9);
    EXPECT_TRUE(section.samples.back().at_seam);
    EXPECT_FALSE(section.samples.front().at_seam);
  }
}

TEST(SweepSections, OfAPartAreThoseOfTheWhole) {
  const surface::DesignSurface design = patch_design();
  const WasteSurface whole = waste_surface(design.mesh, 1);
  const RibAxes axes = sweep_axes(whole, surface::PlaneFamily::parallel(Vector3d(0.6, 0.8, 0)));
  SweepSectionOptions options;
  options.seams = {{Vector3d::UnitX(), 310}, {-Vector3d::UnitY(), -120}};
  const WasteSurface part = part_of(whole, options.seams, 60);
  EXPECT_LT(part.triangles.size(), whole.triangles.size());
  const SweepData of_whole = sweep_sections(whole, axes, options),
                  of_part = sweep_sections(part, axes, options);
  ASSERT_EQ(of_part.sections.size(), of_whole.sections.size());
  for (std::size_t k = 0; k < of_part.sections.size(); ++k) {
    ASSERT_EQ(of_part.sections[k].samples.size(), of_whole.sections[k].samples.size());
    for (std::size_t i = 0; i < of_part.sections[k].samples.size(); ++i)
      EXPECT_EQ(of_part.sections[k].samples[i].q, of_whole.sections[k].samples[i].q);
  }
}

TEST(SweepSections, OfAFanAreThoseOfItsPlanes) {
  // A torus about z: every half plane through z meets it in the same circle, moved by half the kerf.
  const surface::DesignSurface design = grid_design("torus", 60, 60, [](double u, double v) -> Vector3d {
    const double turn = 0.9 * (u - 0.5), a = 1.2 * (v - 0.5), r = 600 + 200 * std::sin(a);
    return {r * std::cos(turn), r * std::sin(turn), 200 * std::cos(a)};
  });
  const WasteSurface surface = waste_surface(design.mesh, -1);
  const surface::PlaneFamily planes = surface::fan_about(design.mesh, {Vector3d::Zero(), Vector3d::UnitZ()});
  const SweepData data = sweep_sections(surface, sweep_axes(surface, planes), {1, 8, 20, 20, {}, {}});
  ASSERT_GT(data.sections.size(), 15U);
  EXPECT_LT(data.steepest_rad, 0.02);
  const Frame plane = data.axes.plane(0);
  const Vector3d centre = planes.turned(Vector3d(600, 0, 0), 0) - plane.origin;
  const Vector2d middle(centre.dot(plane.x), centre.dot(plane.y));
  for (const SweepSection& section : data.sections) {
    for (const SweepSample& sample : section.samples) {
      // Facets of 9 mm by 4 mm lie 0.02 mm inside; at the border normals are half a cell off.
      EXPECT_NEAR((sample.q - middle).norm(), 200 + 0.5, 0.06) << section.offset_mm;
    }
  }
}

// Distance in space of each point of the true surface, moved by its own normal, from the strips' blades.
double largest_distance(const SweptPlan& plan, const Eigen::Isometry3d& turn) {
  double worst = 0;
  for (int i = 0; i <= 40; ++i) {
    for (int j = 0; j <= 40; ++j) {
      const double u = i / 40.0, v = j / 40.0, d = 1e-4;
      const Vector3d p = turn * patch(u, v);
      const Vector3d n =
          (turn.linear() * (patch(u + d, v) - patch(u - d, v)).cross(patch(u, v + d) - patch(u, v - d)))
              .normalized();
      double nearest = 1e300;
      for (const StripPlan& strip : plan.strips) {
        const double sine = std::abs(n.dot(strip.planes.normal(strip.planes.offset(p))));
        const Vector3d t = p + 0.5 * (1 + 8 * sine) * n;
        const double offset = strip.planes.offset(t);
        const Frame plane = strip.plane(offset);
        const Vector2d at((t - plane.origin).dot(plane.x), (t - plane.origin).dot(plane.y));
        if (offset < strip.ribs.front().offset_mm || offset > strip.ribs.back().offset_mm) continue;
        const elastica::Elastica e = RibSpline(strip.ribs).at(offset);
        const std::vector<elastica::CurvePoint> points = sample(e, 3000);
        for (const elastica::CurvePoint& q : points)
          nearest = std::min(nearest, std::sqrt(1 - sine * sine) * (q.position() - at).norm());
      }
      worst = std::max(worst, nearest);
    }
  }
  return worst;
}

TEST(SweepSearch, FollowsTheTrueSurfaceAsCloselyAsItSays) {
  const SweptPlan plan = first_plan(patch_design(), back_kept());
  ASSERT_EQ(plan.strips.size(), 1U);
  EXPECT_LT(plan.deviation_mm, 0.3);
  // Facets of the file and points 0.3 mm apart on the blades.
  EXPECT_LT(largest_distance(plan, Eigen::Isometry3d::Identity()), plan.deviation_mm + 0.1);
}

TEST(SweepSearch, DoesNotDependOnHowTheDesignLies) {
  const SweptPlan as_it_is = first_plan(patch_design(), back_kept());
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.rotate(Eigen::AngleAxisd(1.1, Vector3d(0.3, -0.5, 0.8).normalized()));
  turn.pretranslate(Vector3d(4000, -2500, 900));
  const SweptPlan turned = first_plan(patch_design(turn), back_kept());
  ASSERT_EQ(turned.strips.size(), as_it_is.strips.size());
  EXPECT_NEAR(turned.deviation_mm, as_it_is.deviation_mm, 0.02);
  EXPECT_LT(largest_distance(turned, turn), turned.deviation_mm + 0.1);
}

TEST(SweepSearch, GivesTheSameStripsEachTime) {
  const SweptPlan a = first_plan(patch_design(), back_kept()), b = first_plan(patch_design(), back_kept());
  ASSERT_EQ(a.strips.size(), b.strips.size());
  EXPECT_EQ(a.planes.normal(0), b.planes.normal(0));
  for (std::size_t i = 0; i < a.strips[0].ribs.size(); ++i)
    EXPECT_EQ(a.strips[0].ribs[i].elastica.kappa, b.strips[0].ribs[i].elastica.kappa);
}

TEST(SweepSearch, SplitsWhatNoBlockHolds) {
  Settings small = back_kept();
  small.stock.max_size_mm = {420, 600, 300};
  const SweptPlan plan = first_plan(patch_design(), small);
  ASSERT_GE(plan.strips.size(), 2U);
  for (const StripPlan& strip : plan.strips) {
    Vector3d size = strip.block.size_mm;
    std::sort(size.begin(), size.end());
    EXPECT_LE(size[0], 300);
    EXPECT_LE(size[1], 420);
    EXPECT_LE(size[2], 600);
  }
  EXPECT_LT(largest_distance(plan, Eigen::Isometry3d::Identity()), plan.deviation_mm + 0.1);
}

// What the search asks for, of a patch in small blocks whose strip of this name fails by itself at first.
struct ManyParts {
  struct Look {
    bool alone = false;
    std::vector<std::string> ids;
  };
  std::vector<Look> looks;
  std::size_t given_up = 0;  // how often a plan was handed over at the end

  // `near`: looks tell that strips are 0.2 mm off, S001 0.95; else nothing is told of it.
  ManyParts(const std::string& fails, bool always, bool near = false) {
    Settings small = back_kept();
    small.stock.max_size_mm = {300, 300, 300};
    const auto told = [&](const SweptPlan& plan, bool alone) {
      Look& look = looks.emplace_back();
      look.alone = alone;
      for (const StripPlan& strip : plan.strips) look.ids.push_back(strip.id);
    };
    const auto together = [&](const SweptPlan& plan) -> SweepVerdict {
      told(plan, false);
      return {!always, {}};
    };
    const auto alone = [&](const SweptPlan& plan) -> SweepVerdict {
      const bool first = looks.empty();
      told(plan, true);
      SweepVerdict verdict{!first && !always, {}, {}};
      for (const StripPlan& strip : plan.strips)
        if (near) verdict.deviation_mm.push_back(strip.id == "S001" ? 0.95 : 0.2);
      if (verdict.taken) return verdict;
      for (const StripPlan& strip : plan.strips) verdict.failed.push_back(always || strip.id == fails);
      verdict.too_far = verdict.failed;
      return verdict;
    };
    search_sweeps(patch_design(), small, {together, alone, [&](const SweptPlan&) { ++given_up; }});
  }
};

TEST(SweepSearch, OfManyPartsLooksAtEachByItselfAsItMeetsTheOthersAndThenAtAllTogether) {
  const ManyParts many("S002", false);
  ASSERT_EQ(many.looks.size(), 4U);
  EXPECT_EQ(many.given_up, 0U);
  const std::size_t count = many.looks[0].ids.size();
  ASSERT_GT(count, 4U);
  EXPECT_TRUE(many.looks[0].alone);
  // The halves of what failed, and nothing else.
  EXPECT_TRUE(many.looks[1].alone);
  EXPECT_EQ(many.looks[1].ids, (std::vector<std::string>{"S002", "S003"}));
  EXPECT_TRUE(many.looks[2].alone) << "as they meet";
  EXPECT_EQ(many.looks[2].ids.size(), count + 1);
  EXPECT_FALSE(many.looks[3].alone);
  EXPECT_EQ(many.looks[3].ids, many.looks[2].ids);
}

TEST(SweepSearch, OfManyPartsLooksAgainOnlyAtThoseThatMeetingTheOthersMayHaveLedTooFar) {
  const ManyParts many("S002", false, true);
  ASSERT_EQ(many.looks.size(), 4U);
  EXPECT_TRUE(many.looks[2].alone) << "as they meet";
  EXPECT_EQ(many.looks[2].ids, std::vector<std::string>{"S001"});
  EXPECT_FALSE(many.looks[3].alone);
  EXPECT_EQ(many.looks[3].ids.size(), many.looks[0].ids.size() + 1);
}

TEST(SweepSearch, OfManyPartsThatFailByThemselvesFitsNoneTogetherAndHandsTheLastOver) {
  const ManyParts many("", true);
  ASSERT_GT(many.looks.size(), 1U);
  for (const ManyParts::Look& look : many.looks) EXPECT_TRUE(look.alone);
  EXPECT_EQ(many.given_up, 1U);
}

// How many plans are calmer than others when all strips of each are refused, by their blades' shape or else.
std::size_t calmer_ones(bool misshapen) {
  std::size_t calmer = 0;
  SweepJudges judges;
  judges.together = [&](const SweptPlan& plan) -> SweepVerdict {
    calmer += plan.way == SweepWay::kCalmer ? 1 : 0;
    SweepVerdict verdict;
    verdict.failed.assign(plan.strips.size(), true);
    verdict.too_far.assign(plan.strips.size(), false);
    verdict.misshapen.assign(plan.strips.size(), misshapen);
    return verdict;
  };
  search_sweeps(patch_design(), back_kept(), judges);
  return calmer;
}

TEST(SweepSearch, FitsMoreCalmlyOnlyWhatItsBladesShapeRefuses) {
  EXPECT_GT(calmer_ones(true), 0U);
  EXPECT_EQ(calmer_ones(false), 0U);
}

// How many plans are calmer, and how many split, when of the strips of each the first is refused by its
// blade's shape, and the last by its motion or for leaving the design.
std::pair<std::size_t, std::size_t> calmer_and_split(bool too_far) {
  Settings small = back_kept();
  small.stock.max_size_mm = {420, 600, 300};
  std::pair<std::size_t, std::size_t> ways;
  SweepJudges judges;
  judges.together = [&](const SweptPlan& plan) -> SweepVerdict {
    ways.first += plan.way == SweepWay::kCalmer ? 1 : 0;
    ways.second += plan.way == SweepWay::kSplit ? 1 : 0;
    SweepVerdict verdict;
    for (std::vector<bool>* of : {&verdict.failed, &verdict.too_far, &verdict.misshapen})
      of->assign(plan.strips.size(), false);
    if (plan.strips.size() < 2) return verdict;
    verdict.failed.front() = verdict.failed.back() = verdict.misshapen.front() = true;
    verdict.too_far.back() = too_far;
    return verdict;
  };
  search_sweeps(patch_design(), small, judges);
  return ways;
}

TEST(SweepSearch, SplitsAtOnceWhatItsNeighboursCalmerFitDoesNotHelp) {
  const auto [calmer, split] = calmer_and_split(false);
  EXPECT_EQ(calmer, 0U);
  EXPECT_GT(split, 0U);
  EXPECT_GT(calmer_and_split(true).first, 0U);
}

TEST(SweepSearch, OfFewPartsLooksAtAllTogetherOnly) {
  Settings small = back_kept();
  small.stock.max_size_mm = {420, 600, 300};
  bool alone = false;
  search_sweeps(patch_design(), small,
                {[](const SweptPlan& plan) -> SweepVerdict {
                   return {plan.refusals.empty(), {}};
                 },
                 [&](const SweptPlan&) -> SweepVerdict {
                   alone = true;
                   return {};
                 }});
  EXPECT_FALSE(alone);
}

}  // namespace
}  // namespace hotblade::pipeline
