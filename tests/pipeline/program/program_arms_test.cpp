// Programs with the joints of two arms: written, read back, and refused where they contradict themselves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pipeline/program/program.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/program/armed_vault.hpp"

namespace hotblade::pipeline {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using testing::with_joints;

TEST(ProgramArms, RoundTripByteForByte) {
  const std::string text = to_json(with_joints());
  const Program read = parse_program(text, "job.json");
  EXPECT_EQ(to_json(read), text);
  EXPECT_EQ(read.strips[1].arms->a.turns[5], 2);
  EXPECT_EQ(read.strips[1].joints[3].b[2], with_joints().strips[1].joints[3].b[2]);
  // Laid out in another way it is read as a tree.
  EXPECT_EQ(to_json(parse_program(Json::parse(text).dump(1), "job.json")), text);
}

TEST(ProgramArms, AreReadWithoutDistances) {
  Json json = Json::parse(to_json(with_joints()));
  for (Json& strip : json["strips"]) strip["arms"].erase("nearest_mm");
  const Program read = parse_program(json.dump(), "job.json");
  EXPECT_TRUE(read.strips[0].arms->nearest_mm.empty());
  EXPECT_EQ(read.strips[1].arms->joint_margin_rad.value, 0.5);
}

TEST(ProgramArms, LeaveNoTraceWhereThereAreNone) {
  const std::string text = to_json(testing::vault_program({.strips = 2}));
  for (const char* word : {"\"cell\"", "\"arms\"", "\"joints\""})
    EXPECT_EQ(text.find(word), std::string::npos);
}

std::string refusal(const std::function<void(Json&)>& break_it) {
  Json json = Json::parse(to_json(with_joints()));
  break_it(json);
  try {
    (void)parse_program(json.dump(), "job.json");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kBadInput);
    return error.what();
  }
  return "it was taken";
}

TEST(ProgramArms, AreRefusedWithThePlace) {
  EXPECT_THAT(refusal([](Json& j) { j["strips"][1]["poses"][7].erase("joints"); }),
              HasSubstr("strips[1].poses[7]: \"joints\" is missing"));
  EXPECT_THAT(refusal([](Json& j) { j["strips"][1]["poses"][0].erase("joints"); }),
              HasSubstr("strips[1].poses[0]: \"joints\" is missing"));
  EXPECT_THAT(refusal([](Json& j) { j["strips"][0].erase("arms"); }),
              HasSubstr("strips[0]: \"arms\" is missing"));
  EXPECT_THAT(refusal([](Json& j) { j.erase("cell"); }),
              HasSubstr("strips[0].arms: the program has no cell"));
  EXPECT_THAT(refusal([](Json& j) { j["strips"][1]["poses"][2]["joints"]["b"][4] = -3.5; }),
              HasSubstr("strips[1].poses[2].joints.b[4]: is outside the limits of joint_5 (-3.5, -3 to 3)"));
  EXPECT_THAT(refusal([](Json& j) { j["strips"][1]["poses"][2]["joints"]["b"].erase(0); }),
              HasSubstr("strips[1].poses[2].joints.b"));
  EXPECT_THAT(refusal([](Json& j) { j["strips"][0]["arms"]["b"]["arm"] = "R1"; }),
              HasSubstr("are not both arms"));
  EXPECT_THAT(refusal([](Json& j) { j["strips"][0]["arms"]["b"]["branch"][1] = 0; }), HasSubstr("branch[1]"));
  EXPECT_THAT(refusal([](Json& j) {
                j["strips"][0]["arms"]["nearest_mm"]["arm_cat"] = {1, 2};
              }),
              HasSubstr("strips[0].arms.nearest_mm: has the unknown kind \"arm_cat\""));
  EXPECT_THAT(refusal([](Json& j) { j["strips"][0]["arms"]["nearest_mm"]["blade"][0] = -1; }),
              HasSubstr("nearest_mm.blade[0]"));
  EXPECT_THAT(refusal([](Json& j) { j["strips"][0]["arms"]["a"]["turns"][1] = 0.5; }), HasSubstr("turns[1]"));
  EXPECT_THAT(refusal([](Json& j) { j["cell"]["sha256"] = "x"; }),
              HasSubstr("cell.sha256: is not a SHA-256"));
  EXPECT_THAT(refusal([](Json& j) { j["cell"]["arms"][1]["joints"][2]["max"] = -4; }),
              HasSubstr("cell.arms[1].joints[2]: min is not below max"));
  EXPECT_THAT(refusal([](Json& j) { j["cell"]["colour"] = 1; }), HasSubstr("unknown key \"colour\""));
}

}  // namespace
}  // namespace hotblade::pipeline
