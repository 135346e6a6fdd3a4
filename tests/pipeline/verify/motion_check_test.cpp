#include "pipeline/verify/motion_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "pipeline/plan/plan.hpp"
#include "pipeline/verify/verify.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;

const Program& cylinder_as_planned() {
  static const Program program = plan(cylinder_design(), along_x(), {}).program;
  return program;
}

std::size_t middle_of_cut(const Strip& strip) {
  std::size_t first = 0, last = strip.poses.size() - 1;
  while (!strip.poses[first].foam) ++first;
  while (!strip.poses[last].foam) --last;
  return (first + last) / 2;
}

// What is found of the cylinder's program with its strip edited.
std::vector<std::string> found(const std::function<void(Strip& strip)>& edit) {
  Program program = cylinder_as_planned();
  edit(program.strips.front());
  std::vector<std::string> texts;
  for (const MotionBreach& breach : check_motion(program)) texts.push_back(breach.text);
  return texts;
}

std::string all_of(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += text + "\n";
  return all;
}

TEST(MotionCheck, FindsNothingInAPlan) {
  EXPECT_EQ(all_of(found([](Strip&) {})), "");
  EXPECT_TRUE(verify(cylinder_as_planned(), cylinder_design(), {}).motion.empty());
}

TEST(MotionCheck, FindsClampsBeyondTheMachinesLimits) {
  EXPECT_THAT(all_of(found([](Strip& strip) {
                for (BladePose& pose : strip.poses) pose.t /= 2;
              })),
              HasSubstr("S001: clamp angular acceleration "));
  const std::string moved =
      all_of(found([](Strip& strip) { strip.poses[middle_of_cut(strip)].a.p += Eigen::Vector3d(0, 8, 0); }));
  EXPECT_THAT(moved, ::testing::AnyOf(HasSubstr("clamp speed 1"), HasSubstr("clamp acceleration ")));
  EXPECT_THAT(moved, HasSubstr(" in phase cut at "));
  const std::string low = all_of(found([](Strip& strip) { strip.design_to_cell.p.z() -= 200; }));
  EXPECT_THAT(low, HasSubstr("distance outside the envelope "));
  EXPECT_THAT(low, HasSubstr("clamp height above the table -"));
  EXPECT_THAT(low, HasSubstr("the block's lowest corner above the table -"));
}

TEST(MotionCheck, FindsABladeThatIsCold) {
  const std::string off = all_of(found([](Strip& strip) {
    for (BladePose& pose : strip.poses) pose.heat = false;
  }));
  EXPECT_THAT(off, HasSubstr("S001: the blade is cold (heat) for "));
  EXPECT_THAT(off, HasSubstr("stands hot before it enters the foam 0 s (limit 2 s, motion.preheat_s)"));
  EXPECT_THAT(off, HasSubstr("S001: phase preheat is cold at "));
  EXPECT_THAT(all_of(found([](Strip& strip) { strip.poses[middle_of_cut(strip)].heat = false; })),
              HasSubstr("S001: the blade is cold (heat) for 0.0"));
  EXPECT_THAT(all_of(found([](Strip& strip) { strip.poses[middle_of_cut(strip)].foam.reset(); })),
              HasSubstr("S001: the blade forms nothing (foam) for 0.0"));
  EXPECT_THAT(all_of(found([](Strip& strip) {
                for (BladePose& pose : strip.poses) {
                  if (pose.phase != StripPhase::kPreheat) continue;
                  pose.heat = false;
                  pose.phase = StripPhase::kForm;
                }
              })),
              HasSubstr("stands hot before it enters the foam 0.0"));
}

TEST(MotionCheck, FindsPhasesThatAreNotAsHeatAndFoam) {
  EXPECT_THAT(all_of(found([](Strip& strip) {
                for (BladePose& pose : strip.poses) pose.phase = StripPhase::kTravel;
              })),
              HasSubstr("S001: phase travel is hot at "));
  EXPECT_THAT(
      all_of(found([](Strip& strip) { strip.poses[middle_of_cut(strip)].phase = StripPhase::kLeadIn; })),
      HasSubstr("S001: phase lead_in forms the design at "));
}

TEST(MotionCheck, FindsADwellInFoam) {
  const std::string dwell = all_of(found([](Strip& strip) {
    for (std::size_t i = middle_of_cut(strip); i < strip.poses.size(); ++i) strip.poses[i].t += 60;
  }));
  EXPECT_THAT(dwell, HasSubstr("S001R"));
  EXPECT_THAT(dwell, HasSubstr(": feed of the slowest blade point 0.00"));
  EXPECT_THAT(dwell, HasSubstr("(limit 1 mm/s) in phase cut at "));
}

TEST(MotionCheck, FindsABlockThatTheCutIsNotIn) {
  EXPECT_THAT(all_of(found([](Strip& strip) { strip.block.frame.origin += 500 * strip.block.frame.x; })),
              HasSubstr("distance of what is in foam from the strip's block (stock) "));
  for (const int axis : {0, 1}) {
    EXPECT_THAT(all_of(found([axis](Strip& strip) { strip.block.size_mm[axis] /= 5; })),
                HasSubstr("distance of what is in foam from the strip's block (stock) "));
  }
}

}  // namespace
}  // namespace hotblade::pipeline
