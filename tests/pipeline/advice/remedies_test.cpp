#include "pipeline/advice/remedies.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

// A plan that was refused for these, with the default settings.
PlanResult refused_for(const std::vector<Refusal>& refusals) {
  PlanResult result;
  result.program.settings.blade.free_lengths_mm = {400, 600};
  result.program.settings.machine.plinth_mm = 150;
  result.refusals = refusals;
  return result;
}

Refusal refusal(Limit limit, double value, double bound) {
  return {"S001", "", limit, value, bound};
}

TEST(Remedies, OfAPassedPlanAreNone) {
  EXPECT_TRUE(remedies(refused_for({})).empty());
}

TEST(Remedies, NameSettingAndNumberByLimit) {
  const struct {
    Refusal refusal;
    const char *setting, *needed;
  } cases[] = {
      {refusal(Limit::kDeviation, 1.234, 1), "design.tolerance_mm", "1.3 mm"},
      {refusal(Limit::kDeviation, 1.2, 1), "design.tolerance_mm", "1.2 mm"},
      // An elastica may have half of the tolerance.
      {refusal(Limit::kRibDeviation, 0.6, 0.5), "design.tolerance_mm", "1.2 mm"},
      {refusal(Limit::kUncutShare, 4.21, 1), "design.max_uncut_share", "0.043"},
      {refusal(Limit::kRibRadius, 56, 70), "blade.thickness_mm", "0.4 mm"},
      {refusal(Limit::kBendingStress, 700, 673), "blade.thickness_mm", "0.48 mm"},
      {refusal(Limit::kSlowestFeed, 0.777, 1), "motion.min_feed_mm_s", "0.77 mm/s"},
      {refusal(Limit::kClampHeight, 30.5, 40), "machine.plinth_mm", "160 mm"},
      {refusal(Limit::kBlockEdge, 1300.5, 1200), "stock.max_size_mm", "1301 mm"},
      {refusal(Limit::kRibLength, 640, 600), "blade.free_lengths_mm", "750 mm"},
      {refusal(Limit::kClampClearance, 10, 40), "blade.free_lengths_mm", "700 mm"},
  };
  for (const auto& c : cases) {
    const std::vector<Remedy> list = remedies(refused_for({c.refusal}));
    ASSERT_EQ(list.size(), 1u) << limit_text(c.refusal);
    EXPECT_EQ(list[0].setting, c.setting) << limit_text(c.refusal);
    EXPECT_EQ(list[0].needed, c.needed) << limit_text(c.refusal);
    EXPECT_EQ(list[0].refusals, 1u);
  }
}

TEST(Remedies, TakeTheMostDemandingRefusalOfASetting) {
  const std::vector<Remedy> list =
      remedies(refused_for({refusal(Limit::kDeviation, 1.5, 1), refusal(Limit::kRibDeviation, 2, 0.5),
                            refusal(Limit::kBendingStress, 700, 673), refusal(Limit::kBladeYield, 60, 70)}));
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].needed, "4 mm");
  EXPECT_EQ(list[1].needed, "0.42 mm");
  EXPECT_EQ(list[0].refusals, 2u);
  EXPECT_EQ(list[1].refusals, 2u);
}

TEST(Remedies, AreNotInventedWhereNoNumberHelps) {
  for (const Refusal& r : {refusal(Limit::kPlannedMargin, 0.1, 1), refusal(Limit::kSelfCrossing, 1, 0),
                           refusal(Limit::kUncutShare, 100, 1), refusal(Limit::kBladeYield, 3.5, 70),
                           refusal(Limit::kDeviation, NAN, 1), refusal(Limit::kDeviation, 400, 1)}) {
    EXPECT_TRUE(remedies(refused_for({r})).empty()) << limit_text(r) << r.value;
  }
}

// What is said has to hold: the job is planned again with it.
TEST(Remedies, ToleranceOfARefusedJobIsOneThatItPassesWith) {
  // So coarse that a smooth cut across its facets is measured to be off by more than its fit is.
  Settings settings = along_x();
  settings.design.tolerance_mm = 0.1;
  const surface::DesignSurface design = cylinder_design(12);
  const PlanResult refused = plan(design, settings, {});
  const std::vector<Remedy> list = remedies(refused);
  ASSERT_EQ(list.size(), 1u);
  ASSERT_EQ(list[0].setting, "design.tolerance_mm");
  settings.design.tolerance_mm = std::stod(list[0].needed);
  EXPECT_GE(settings.design.tolerance_mm, refused.verification.deviation.max);
  EXPECT_EQ(plan(design, settings, {}).program.verification.status, VerificationStatus::kPassed);
}

}  // namespace
}  // namespace hotblade::pipeline
