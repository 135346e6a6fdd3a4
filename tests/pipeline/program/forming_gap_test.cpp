#include "pipeline/program/forming_gap.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

// The first pose in foam of the vault's strip.
std::size_t first_in_foam(const Strip& strip) {
  std::size_t first = 0;
  while (!strip.poses[first].foam) ++first;
  return first;
}

TEST(FormingGap, IsWhereABladeIsColdOrFormsNothingBetweenThePosesThatFormTheDesign) {
  const Strip whole = testing::vault_program().strips.front();
  EXPECT_FALSE(forming_gap(whole));
  const std::size_t first = first_in_foam(whole);
  for (const bool cold : {true, false}) {
    for (const std::size_t from : {first, first + 5}) {
      if (!cold && from == first) continue;  // the strip then begins to form the design later
      Strip strip = whole;
      for (std::size_t i = from; i < from + 3; ++i) {
        if (cold) strip.poses[i].heat = false;
        if (!cold) strip.poses[i].foam.reset();
      }
      const auto gap = forming_gap(strip);
      ASSERT_TRUE(gap);
      EXPECT_EQ(gap->first, from);
      EXPECT_EQ(gap->last, from + 2);
      EXPECT_EQ(gap->cold, cold);
      const std::string said = describe(strip, *gap);
      EXPECT_NE(said.find("S001: the blade "), std::string::npos) << said;
      EXPECT_NE(said.find("for 0.15 s"), std::string::npos) << said;
      EXPECT_NE(said.find("pose " + std::to_string(from)), std::string::npos) << said;
    }
  }
  // Cold beside the cut is how a strip begins and ends.
  Strip strip = whole;
  strip.poses[first - 1].heat = false;
  EXPECT_FALSE(forming_gap(strip));
  for (BladePose& pose : strip.poses) pose.foam.reset();
  EXPECT_FALSE(forming_gap(strip));
}

TEST(ReadStripJobs, RefusesAProgramWhoseBladeIsColdInFoam) {
  Program program = testing::vault_program();
  Strip& strip = program.strips.front();
  strip.poses[first_in_foam(strip) + 4].heat = false;
  const testing::TemporaryDirectory directory;
  const auto file = directory / "program.json";
  std::ofstream(file) << to_json(program);
  try {
    (void)read_strip_jobs(file, false);
    FAIL() << "was not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kNotCuttable);
    EXPECT_NE(std::string(error.what()).find("S001: the blade is cold (heat) for 0.05 s"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(read_strip_jobs(file, true).jobs.size(), 1u);
}

}  // namespace
}  // namespace hotblade::pipeline
