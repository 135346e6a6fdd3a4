// Of refused plans, the one that is shown.
#include "pipeline/plan/nearest_plan.hpp"

#include <gmock/gmock.h>

namespace hotblade::pipeline {
namespace {

SweptPlan swept(std::size_t strips, std::vector<Limit> missing = {}) {
  SweptPlan plan;
  plan.strips.resize(strips);
  for (const Limit limit : missing) plan.refusals.push_back({"S001", "", limit, 2, 1});
  return plan;
}

PlanResult verified(std::size_t strips, const std::vector<std::pair<std::string, Limit>>& refusals) {
  PlanResult result;
  for (std::size_t i = 1; i <= strips; ++i) {
    StripFacts facts;
    facts.id = "S00" + std::to_string(i);
    result.strips.push_back(facts);
  }
  for (const auto& [strip, limit] : refusals) result.refusals.push_back({strip, "", limit, 2, 1});
  return result;
}

TEST(NearestPlan, WasVerifiedIfAnyWas) {
  const PlanResult poor = verified(3, {{"S001", Limit::kDeviation}, {"S002", Limit::kPlannedMargin}});
  EXPECT_LT(nearness(swept(3), &poor), nearness(swept(1, {Limit::kStrips}), nullptr));
}

TEST(NearestPlan, BreaksTheFewestKindsOfLimitsBeforeTheFewestStripsFail) {
  const PlanResult one_kind = verified(3, {{"S001", Limit::kDeviation}, {"S002", Limit::kDeviation}});
  const PlanResult two_kinds = verified(3, {{"S001", Limit::kDeviation}, {"S001", Limit::kPlannedMargin}});
  EXPECT_LT(nearness(swept(3), &one_kind), nearness(swept(3), &two_kinds));
  const PlanResult fewer = verified(3, {{"S001", Limit::kDeviation}});
  EXPECT_LT(nearness(swept(3), &fewer), nearness(swept(3), &one_kind));
  EXPECT_LT(nearness(swept(2), &fewer), nearness(swept(3), &fewer)) << "then the fewest strips";
  EXPECT_LT(nearness(swept(1, {Limit::kDeviation}), nullptr),
            nearness(swept(1, {Limit::kDeviation, Limit::kDeviation}), nullptr));
}

Refusal over(Limit limit, double value, double bound) {
  return {"S001", "", limit, value, bound};
}

TEST(NearestPlan, KeepsTheToleranceOrIsTheLeastOverTheSameLimit) {
  const auto unplanned = [](const std::vector<Refusal>& refusals) {
    SweptPlan plan;
    plan.refusals = refusals;
    return nearness(plan, nullptr);
  };
  // A blade that would snap too early fits the design; one that leaves it may be split for that.
  const Refusal off = over(Limit::kDeviation, 1.484, 1), margin = over(Limit::kPlannedMargin, 42.75, 100);
  EXPECT_LT(unplanned({margin, margin, margin}), unplanned({off}));
  EXPECT_LT(unplanned({over(Limit::kPlannedMargin, 61.25, 100)}), unplanned({margin}));
  EXPECT_LT(unplanned({margin, margin}), unplanned({margin, over(Limit::kPlannedMargin, 39.86, 100)}));
  PlanResult three = verified(3, {}), four = verified(4, {});
  three.refusals = {over(Limit::kDeviation, 0.1286, 0.05)};
  four.refusals = {over(Limit::kDeviation, 0.0564, 0.05)};
  EXPECT_LT(nearness(swept(4), &four), nearness(swept(3), &three));
}

TEST(NearestPlan, NamesTheStripsThatFail) {
  PlanResult result = verified(3, {{"S002 lead_in", Limit::kClampClearance}});
  EXPECT_THAT(failed_strips(result), ::testing::ElementsAre(false, true, false));
  result.strips[2].deviation_bound_mm = 1.5;
  EXPECT_THAT(failed_strips(result), ::testing::ElementsAre(false, true, true));
  EXPECT_THAT(failed_strips(verified(2, {{"design", Limit::kUncutShare}})), ::testing::IsEmpty());
}

TEST(NearestPlan, NamesTheStripsThatTheirBladesShapeRefuses) {
  const PlanResult result = verified(
      3,
      {{"S001", Limit::kSlowestFeed}, {"S002 lead_in", Limit::kClampClearance}, {"S003", Limit::kSnapError}});
  EXPECT_THAT(misshapen_strips(result), ::testing::ElementsAre(false, true, true));
}

}  // namespace
}  // namespace hotblade::pipeline
