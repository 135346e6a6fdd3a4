// What reports say of arms.
#include "pipeline/report/arms_section.hpp"
#include "pipeline/report/json/report_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "robot/arm/clearance.hpp"
#include "tests/pipeline/program/armed_vault.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ArmsSection, SaysReachMarginsDistancesAndTime) {
  PlanResult result;
  EXPECT_THAT(arms_section(result, Words("en")), IsEmpty()) << "no cell, no arms";
  result.program = testing::with_joints();
  const std::string html = arms_section(result, Words("en"));
  for (const char* words : {"a &quot;cell&quot;", "<td>R1</td><td>R2</td><td>200; -150, 300; 29", "75 % R2",
                            "R1 J4", "arm to arm 412 mm, arm to blade 61 mm", "<td>2.0</td>"})
    EXPECT_THAT(html, HasSubstr(words));
  EXPECT_THAT(arms_section(result, Words("de")), HasSubstr("Reichweite"));
  EXPECT_THAT(arms_section(result, Words("de")), HasSubstr("Arm zu Arm 412 mm, Arm zu Klinge 61 mm"));
  for (const robot::PairKind kind : robot::kPairKinds) {
    const std::string words = robot::pair_words(robot::name(kind));
    EXPECT_THAT(words, HasSubstr(" to "));
    EXPECT_NO_THROW(EXPECT_THAT(Words("de")(words), HasSubstr(" zu ")));
  }
  const nlohmann::ordered_json json = arms_json(*result.program.strips[0].arms);
  EXPECT_EQ(json["b"]["arm"], "R2");
  EXPECT_EQ(json["b"]["flip"], true);
  EXPECT_NEAR(json["joint_margin"]["deg"].get<double>(), 28.6479, 1e-3);
  EXPECT_EQ(json["joint_margin"]["joint"], 4);
  EXPECT_EQ(json["reach"]["share"], 0.75);
  EXPECT_EQ(json["nearest"]["blade"]["mm"], 61.25);
  EXPECT_EQ(json["added_s"]["joints"], 1.5);
}

}  // namespace
}  // namespace hotblade::pipeline
