// What a refusal for the deviation says.
#include "pipeline/plan/deviation_reasons.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

// Of two strips the first is measured to deviate the most, and the second has the larger bound.
PlanResult two_strips() {
  PlanResult result;
  result.program = testing::vault_program({2});
  VerifyReport& v = result.verification;
  v.strip_max_mm = {0.138, 0.034};
  v.strip_bound_mm = {0.146, 0.189};
  v.strip_told_mm = {0.001, 0.155};
  for (const Strip& strip : result.program.strips) {
    result.strips.emplace_back().id = strip.id;
    v.strip_max_at.push_back(strip.ribs.back().frame.origin);
  }
  v.deviation.max = 0.138;
  v.deviation.at = v.strip_max_at[0];
  v.bound_mm = 0.189;
  return result;
}

TEST(DeviationRefusal, HasStripPlaceAndAmountOfOneStrip) {
  PlanResult result = two_strips();
  const Strip& second = result.program.strips[1];
  const Refusal refusal = deviation_refusal(result, 0.03);
  EXPECT_EQ(refusal.strip, second.id);
  EXPECT_EQ(refusal.rib, second.ribs.back().id);
  EXPECT_EQ(*refusal.at, result.verification.strip_max_at[1]);
  EXPECT_EQ(refusal.value, 0.189);
  const Eigen::Vector3d& at = *refusal.at;
  EXPECT_EQ(describe(refusal),
            fmt::format("{} at ({:.1f}, {:.1f}, {:.1f}): deviation 0.189 mm (limit 0.03 mm), measured there "
                        "0.034 mm",
                        second.ribs.back().id, at.x(), at.y(), at.z()));
  EXPECT_NE(deviation_refusal(result, 0.04).note, "") << "within it but for the registers";
  // Measured as far off as the bound, or nearly: said once.
  result.verification.strip_max_mm[1] = 0.18;
  EXPECT_EQ(deviation_refusal(result, 0.03).when, "");
}

TEST(DeviationRefusal, NamesNoRibWithoutTheProgramsStrips) {
  PlanResult result = two_strips();
  result.program.strips.clear();
  const Refusal refusal = deviation_refusal(result, 0.03);
  EXPECT_EQ(refusal.strip, result.strips[1].id);
  EXPECT_EQ(refusal.rib, "");
}

}  // namespace
}  // namespace hotblade::pipeline
