// Strips that are looked at again and again: what is known of one serves, under whatever name, and is what a
// look from the beginning would find.
#include "pipeline/plan/strip_looks.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/plan/sweep/sweep_search.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

struct TwoStrips {
  surface::DesignSurface design = grid_design("vault", 40, 30, [](double u, double v) -> Vector3d {
    const double x = 700 * u, y = 300 * v;
    return {x, y, 60 * std::sin(2.5 * u) + 20 * v * v};
  });
  Settings settings;
  std::vector<StripPlan> strips;

  TwoStrips() {
    settings.design.units = "mm";
    settings.design.keep = Keep::kBack;
    settings.stock.max_size_mm = {500, 500, 500};
    const auto judge = [&](const SweptPlan& plan) -> SweepVerdict {
      strips = plan.strips;
      return {plan.refusals.empty(), {}};
    };
    search_sweeps(design, settings, {judge, judge});
  }
  [[nodiscard]] Program like() const {
    Program program;
    program.settings = settings;
    program.blade = settings.blade;
    return program;
  }
  void look(StripLooks& looks, const std::vector<StripPlan>& at) const {
    looks.pose(at, settings, [](double) {});
    looks.measure_fresh(like(), design, {});
  }
};

TEST(StripLooks, KnowAStripAgainUnderAnotherName) {
  const TwoStrips two;
  ASSERT_GE(two.strips.size(), 2U);
  for (const MotionLook how : {MotionLook::kFull, MotionLook::kCoarse}) {
    StripLooks looks(how);
    two.look(looks, two.strips);
    EXPECT_EQ(looks.fresh(), 0U);
    const PlanResult before = looks.known();
    StripPlan renamed = two.strips[1];
    renamed.id = "S007";
    renamed.seam_before.gap_mm = 0.25;
    looks.pose({renamed}, two.settings, [](double) { FAIL() << "nothing is to be posed"; });
    EXPECT_EQ(looks.fresh(), 0U);
    const PlanResult after = looks.known();
    ASSERT_EQ(after.strips.size(), 1U);
    EXPECT_EQ(after.strips[0].id, "S007");
    EXPECT_EQ(after.strips[0].seam.gap_mm, 0.25);
    EXPECT_EQ(after.strips[0].deviation_max_mm, before.strips[1].deviation_max_mm);
    EXPECT_GT(after.strips[0].deviation_max_mm, 0);
    for (const std::string& warning : after.warnings) EXPECT_EQ(warning.find("S002"), std::string::npos);
    StripLooks anew(how);
    two.look(anew, {renamed});
    EXPECT_EQ(anew.known().warnings, after.warnings);
    EXPECT_NEAR(anew.known().strips[0].deviation_max_mm, after.strips[0].deviation_max_mm, 1e-9);
  }
}

TEST(StripLooks, PoseAStripAnewWhoseBladesChanged) {
  const TwoStrips two;
  ASSERT_GE(two.strips.size(), 2U);
  StripLooks looks(MotionLook::kFull);
  two.look(looks, two.strips);
  std::vector<StripPlan> moved = two.strips;
  moved[0].ribs.front().elastica.kappa += 1e-9;
  looks.pose(moved, two.settings, [](double) {});
  EXPECT_EQ(looks.fresh(), 1U);
}

TEST(StripLooks, GiveTheirStripsAwayAndTakeThemBack) {
  const TwoStrips two;
  StripLooks looks(MotionLook::kFull);
  two.look(looks, two.strips);
  PlanResult given;
  given.program = two.like();
  looks.give(given);
  ASSERT_EQ(given.program.strips.size(), two.strips.size());
  const std::size_t poses = given.program.strips[0].poses.size();
  EXPECT_GT(poses, 100U);
  given.verification = verify(given.program, two.design, {});
  looks.take_back(given);
  EXPECT_TRUE(given.program.strips.empty());
  PlanResult again;
  looks.give(again);
  EXPECT_EQ(again.program.strips[0].poses.size(), poses);
}

}  // namespace
}  // namespace hotblade::pipeline
