// The table of limits: complete, unambiguous, and with the codes that STATUS has had from the first.
#include "robot/pose/limit.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "tests/paths.hpp"

namespace hotblade::robot {
namespace {

TEST(Limits, EveryOneHasANameOfItsOwnAndAUnit) {
  const std::set<std::string> units{"",       "mm",     "mm/s", "mm/s2", "mm/s3", "rad",    "rad/s",
                                    "rad/s2", "rad/s3", "MPa",  "s",     "%",     "degrees"};
  std::set<std::string> names;
  for (const LimitInfo& i : limits()) {
    EXPECT_STRNE(i.name, "");
    EXPECT_TRUE(units.contains(i.unit)) << i.name << ": " << i.unit;
    EXPECT_TRUE(names.insert(i.name).second) << i.name << " stands twice";
    EXPECT_EQ(info(i.limit).limit, i.limit);
  }
  EXPECT_EQ(limits().size(), static_cast<std::size_t>(Limit::kUnknown) + 1);
}

// What would help is told when it was tried and passed; a limit says what it means.
TEST(Limits, GiveNoAdvice) {
  for (const LimitInfo& i : limits()) {
    const std::string words = " " + std::string(i.meaning) + " ";
    for (const char* advice :
         {" more splits", " larger ", " longer ", " shorter ", " thinner ", " wider ", " closer ", " lower ",
          " raise ", " allow ", " another slice", " add ", " choose ", " set ", " leave ", " check "})
      EXPECT_EQ(words.find(advice), std::string::npos) << i.name << ": " << i.meaning;
  }
}

TEST(Limits, OfTheBladesShapeAreTheseAndNoneOfItsMotion) {
  for (const Limit limit :
       {Limit::kSnapError, Limit::kBendingStress, Limit::kPlannedMargin, Limit::kFreePart})
    EXPECT_TRUE(is_of_the_shape(limit)) << info(limit).name;
  for (const Limit limit : {Limit::kSlowestFeed, Limit::kClampHeight, Limit::kDuration, Limit::kSpeed,
                            Limit::kDeviation, Limit::kSag})
    EXPECT_FALSE(is_of_the_shape(limit)) << info(limit).name;
}

TEST(Limits, CodesAreThoseOfTheProtocol) {
  const std::map<std::uint16_t, std::pair<Limit, std::string>> protocol{
      {1, {Limit::kCount, "number of waypoints or misplaced last flag"}},
      {2, {Limit::kQuaternion, "quaternion is not of unit length"}},
      {3, {Limit::kHeat, "heat bits of the clamps differ"}},
      {4, {Limit::kTime, "time does not increase"}},
      {5, {Limit::kMinDt, "time step below the minimum"}},
      {6, {Limit::kStartPose, "start pose is no flat circular arc of the blade"}},
      {7, {Limit::kEnvelope, "position outside the envelope"}},
      {8, {Limit::kSpeed, "speed"}},
      {9, {Limit::kAcceleration, "acceleration"}},
      {10, {Limit::kAngularSpeed, "angular speed"}},
      {11, {Limit::kAngularAcceleration, "angular acceleration"}},
      {12, {Limit::kChord, "chord too long for the blade"}},
      {13, {Limit::kBlade, "blade data or number of waypoints out of range"}},
      {14, {Limit::kHeldPose, "path does not continue from the held pose"}},
      {15, {Limit::kBladePlane, "clamps are not in one plane"}},
      {16, {Limit::kBladeReach, "blade is pulled taut, the clamps are too far apart"}},
      {17, {Limit::kBladeSnap, "blade snaps through"}},
      {18, {Limit::kBladeYield, "blade would yield"}},
      {19, {Limit::kBladeMargin, "blade's stability margin is too small"}},
      {20, {Limit::kCell, "arms are not declared, or not those of this cell at waypoint 0"}},
      {21, {Limit::kArmReach, "arm does not reach"}},
      {22, {Limit::kJointAngle, "joint limit"}},
      {23, {Limit::kJointSpeed, "joint speed"}},
      {24, {Limit::kJointAcceleration, "joint acceleration"}},
      {25, {Limit::kNearSingular, "arm is next to singular"}},
      {26, {Limit::kConfiguration, "arm's configuration would change"}},
      {27, {Limit::kArmClearance, "too near in the cell"}},
      {28, {Limit::kJointJerk, "jerk of a joint or clamp"}},
  };
  std::size_t coded = 0;
  for (const LimitInfo& i : limits()) {
    if (i.code == 0) continue;
    ++coded;
    const auto entry = protocol.find(i.code);
    ASSERT_NE(entry, protocol.end()) << i.name << " has the code " << i.code;
    EXPECT_EQ(entry->second.first, i.limit) << i.code;
    EXPECT_EQ(entry->second.second, i.fault) << i.code;
    EXPECT_EQ(limit_of_code(i.code), i.limit) << "a code that stands twice";
  }
  EXPECT_EQ(coded, protocol.size());
  EXPECT_EQ(limit_of_code(0), Limit::kNone);
  EXPECT_EQ(limit_of_code(29), Limit::kUnknown);
  EXPECT_EQ(limit_of_code(0xFFFF), Limit::kUnknown);
}

TEST(Limits, TheProtocolsPageListsEveryCode) {
  std::ostringstream page;
  page << std::ifstream(hotblade::testing::source_dir() + "/docs/controller-protocol.md").rdbuf();
  const std::string text = page.str();
  const auto begin = text.find("Limit codes: ");
  ASSERT_NE(begin, std::string::npos);
  const std::string list = text.substr(begin, text.find("\n\n", begin) - begin);
  for (const LimitInfo& i : limits()) {
    if (i.code > 0) {
      EXPECT_NE(list.find(" " + std::to_string(i.code) + " "), std::string::npos) << i.fault;
    }
  }
  EXPECT_EQ(list.find(" 29 "), std::string::npos) << "a code without an entry";
}

}  // namespace
}  // namespace hotblade::robot
