#include "pipeline/sayings/saying.hpp"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <string>

namespace hotblade::pipeline {
namespace {

TEST(Sayings, HaveTheirValuesInTheirPlaces) {
  EXPECT_EQ(say(Saying::kInPhase, {"cut", 12.5}), " in phase cut at 12.50 s");
  EXPECT_EQ(say(Saying::kStripsAtLeast, {1234567.0, std::size_t{17}}),
            "largest extent 1.23457e+06 mm: 17 strips at least");
  EXPECT_EQ(say(Saying::kOfDesign, {say(Saying::kClampsNotEnough, {0.5})}),
            "design: not within 0.5 mm for certain, however exact the clamps are");
  EXPECT_EQ(say(Saying::kThermal), "thermal spring-back");
}

TEST(Sayings, TakeNeitherTooFewValuesNorWordsForNumbers) {
  EXPECT_THROW((void)say(Saying::kInPhase, {"cut"}), std::logic_error);
  EXPECT_THROW((void)say(Saying::kInPhase, {"cut", "soon"}), std::logic_error);
}

TEST(Sayings, AreAllDifferent) {
  std::set<std::string> seen;
  for (const SayingInfo& info : sayings()) {
    EXPECT_TRUE(seen.insert(info.english).second) << info.english;
    EXPECT_FALSE(std::string(info.english).empty());
  }
}

}  // namespace
}  // namespace hotblade::pipeline
