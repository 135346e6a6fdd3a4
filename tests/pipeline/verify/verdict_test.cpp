// Green, amber or red: what a budget that is over the tolerance says of a plan that passed.
#include "pipeline/verify/verdict.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/plan/plan.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/clamp_error.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Settings with_clamps(double mm, double rad) {
  Settings settings = along_x();
  settings.machine.clamp_error_mm = mm;
  settings.machine.clamp_error_rad = rad;
  settings.blade.min_margin_mm = 0.01;  // no clamps are refused for what they may snap
  return settings;
}

// What the clamps move the blade by at the ribs, with errors other than those it was planned with.
double moved_mm(const Program& program, const ClampErrors& errors) {
  MachineSettings machine = program.settings.machine;
  machine.clamp_error_mm = errors.position_mm;
  machine.clamp_error_rad = errors.angle_rad;
  double most = 0;
  for (const Strip& strip : program.strips) {
    for (const BladePose& pose : strip.poses) {
      if (pose.rib) most = std::max(most, clamp_error_mm(pose, pose.margin_mm.value(), machine));
    }
  }
  return most;
}

TEST(Verdict, OfABudgetWithinTheToleranceIsGreen) {
  const PlanResult result = plan(cylinder_design(), with_clamps(0.01, 2e-5), {});
  const Verdict verdict = verdict_of(result.program);
  ASSERT_LE(verdict.budget_mm, 1);
  EXPECT_EQ(verdict.color, VerdictColor::kGreen);
  EXPECT_EQ(verdict.budget_mm, budget_sum_mm(result.program.verification.budget_mm));
  EXPECT_EQ(headline(verdict), "can be cut as planned");
  EXPECT_FALSE(verdict.needed);
  for (const std::string& warning : result.warnings) EXPECT_THAT(warning, Not(HasSubstr("error budget")));
}

TEST(Verdict, OfABudgetOverTheToleranceIsAmberAndItsClampsBringItWithin) {
  for (const double mm : {0.8, 2.0, 10.0}) {
    const PlanResult result = plan(cylinder_design(), with_clamps(mm, 0.002), {});
    ASSERT_TRUE(result.refusals.empty()) << describe(result.refusals.front());
    const Verdict verdict = verdict_of(result.program);
    ASSERT_EQ(verdict.color, VerdictColor::kAmber) << mm;
    ASSERT_TRUE(verdict.needed) << mm;
    EXPECT_NEAR(verdict.needed->angle_rad / verdict.needed->position_mm, 0.002 / mm, 0.1 * 0.002 / mm);
    const double others = verdict.budget_mm - verdict.clamp_mm;
    EXPECT_LE(others + moved_mm(result.program, *verdict.needed), 1) << mm;
    // Rounded down by at most a tenth: a fifth more is too much.
    const ClampErrors more{1.2 * verdict.needed->position_mm, 1.2 * verdict.needed->angle_rad};
    EXPECT_GT(others + moved_mm(result.program, more), 1) << mm;
    EXPECT_THAT(headline(verdict), HasSubstr("can be cut within 1 mm if the clamps are within "));
    ASSERT_FALSE(result.warnings.empty());
    EXPECT_THAT(result.warnings.back(), HasSubstr(needed_text(verdict)));
  }
}

TEST(Verdict, PlannedWithTheClampsItAsksForIsGreen) {
  const PlanResult amber = plan(cylinder_design(), with_clamps(2, 0.002), {});
  const auto needed = verdict_of(amber.program).needed;
  ASSERT_TRUE(needed);
  const PlanResult again = plan(cylinder_design(), with_clamps(needed->position_mm, needed->angle_rad), {});
  EXPECT_EQ(verdict_of(again.program).color, VerdictColor::kGreen) << budget_text(verdict_of(again.program));
}

TEST(Verdict, SaysWhereNoClampsAreExactEnough) {
  Program program = plan(cylinder_design(), with_clamps(0.1, 2e-4), {}).program;
  program.verification.budget_mm.emplace_back("another_line", 1.0);
  const Verdict verdict = verdict_of(program);
  EXPECT_EQ(verdict.color, VerdictColor::kAmber);
  EXPECT_FALSE(verdict.needed);
  EXPECT_THAT(headline(verdict), HasSubstr("however exact the clamps are"));
  EXPECT_TRUE(to_json(verdict)["clamps_needed"].is_null());
}

TEST(Verdict, ABudgetThatIsNoNumberIsNotGreen) {
  Program program = plan(cylinder_design(), with_clamps(0.01, 2e-5), {}).program;
  program.verification.budget_mm.emplace_back("another_line", std::nan(""));
  EXPECT_EQ(verdict_of(program).color, VerdictColor::kAmber);
}

TEST(Verdict, OfARefusedPlanIsRedWhateverItsBudget) {
  Program program = plan(cylinder_design(), with_clamps(0.01, 2e-5), {}).program;
  program.verification.status = VerificationStatus::kRefused;
  EXPECT_EQ(verdict_of(program).color, VerdictColor::kRed);
}

TEST(Verdict, ASettingMakesTheBudgetBinding) {
  Settings settings = with_clamps(2, 0.002);
  settings.design.over_budget = OverBudget::kRefuse;
  const PlanResult result = plan(cylinder_design(), settings, {});
  ASSERT_EQ(result.refusals.size(), 1u);
  EXPECT_EQ(result.refusals.front().limit, Limit::kBudget);
  EXPECT_THAT(describe(result.refusals.front()), HasSubstr("within 1 mm if the clamps are within "));
  EXPECT_EQ(result.program.verification.status, VerificationStatus::kRefused);
  EXPECT_EQ(verdict_of(result.program).color, VerdictColor::kRed);
}

}  // namespace
}  // namespace hotblade::pipeline
