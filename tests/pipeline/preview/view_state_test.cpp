// Keys, time and clicks change the state as the help says; no display is needed for any of it.
#include "pipeline/preview/view_state.hpp"

#include <gmock/gmock.h>

namespace hotblade::pipeline::preview {
namespace {

// Two strips of five poses, one a second; the second starts when the first ends.
ViewFacts two_strips() {
  ViewFacts facts;
  facts.strip_start_s = {0, 4, 8};
  facts.pose_s = {0, 1, 2, 3, 4, 4, 5, 6, 7, 8};
  facts.first_pose = {0, 5, 10};
  facts.colors = {Color::kStrip, Color::kCurvature, Color::kMargin, Color::kFeed};
  return facts;
}

ViewState pressed(std::initializer_list<const char*> keys, ViewState state = {}) {
  for (const char* key : keys) state = after_key(state, two_strips(), key);
  return state;
}

TEST(ViewState, SpacePlaysAndPauses) {
  EXPECT_TRUE(pressed({"space"}).playing);
  EXPECT_FALSE(pressed({"space", "space"}).playing);
}

TEST(ViewState, PlayingRunsAtItsSpeedAndStopsAtTheEnd) {
  ViewState state = pressed({"space"});
  state.speed = 4;
  state = after_clock(state, two_strips(), 0.5);
  EXPECT_DOUBLE_EQ(state.time_s, 2);
  EXPECT_TRUE(state.playing);
  state = after_clock(state, two_strips(), 100);
  EXPECT_DOUBLE_EQ(state.time_s, 8);
  EXPECT_FALSE(state.playing);
  EXPECT_DOUBLE_EQ(after_key(state, two_strips(), "space").time_s, 0) << "plays again from the start";
}

TEST(ViewState, ThePausedStateDoesNotMoveWithTheClock) {
  EXPECT_DOUBLE_EQ(after_clock({}, two_strips(), 5).time_s, 0);
}

TEST(ViewState, ArrowsStepThroughEveryPoseBothWays) {
  ViewState state;
  std::vector<double> forward;
  for (int i = 0; i < 10; ++i) {
    state = after_key(state, two_strips(), "Right");
    forward.push_back(state.time_s);
  }
  EXPECT_THAT(forward, ::testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 8, 8));
  for (int i = 0; i < 10; ++i) state = after_key(state, two_strips(), "Left");
  EXPECT_DOUBLE_EQ(state.time_s, 0);
  state.time_s = 2.5;
  EXPECT_DOUBLE_EQ(after_key(state, two_strips(), "Left").time_s, 2);
  EXPECT_DOUBLE_EQ(after_key(state, two_strips(), "Right").time_s, 3);
}

TEST(ViewState, PageKeysGoFromStripToStrip) {
  ViewState state;
  state.time_s = 5;
  EXPECT_DOUBLE_EQ(after_key(state, two_strips(), "Prior").time_s, 4);
  EXPECT_DOUBLE_EQ(pressed({"Prior", "Prior"}, state).time_s, 0);
  EXPECT_DOUBLE_EQ(pressed({"Next"}).time_s, 4);
  EXPECT_DOUBLE_EQ(pressed({"Next", "Next", "Next"}).time_s, 8);
}

TEST(ViewState, SpeedDoublesAndHalvesWithinBounds) {
  EXPECT_DOUBLE_EQ(pressed({"plus"}).speed, 2 * ViewState{}.speed);
  EXPECT_DOUBLE_EQ(pressed({"plus", "minus"}).speed, ViewState{}.speed);
  ViewState fast, slow;
  for (int i = 0; i < 30; ++i) {
    fast = after_key(fast, two_strips(), "plus");
    slow = after_key(slow, two_strips(), "minus");
  }
  EXPECT_DOUBLE_EQ(fast.speed, 512);
  EXPECT_DOUBLE_EQ(slow.speed, 0.125);
}

TEST(ViewState, EveryLayerHasAKeyThatHidesAndShowsIt) {
  std::bitset<kLayers> all;
  for (const char* key : {"d", "c", "r", "b", "k", "g", "p", "l", "m"}) {
    const ViewState once = pressed({key});
    EXPECT_EQ(once.hidden.count(), 1u) << key;
    all |= once.hidden;
    EXPECT_TRUE(pressed({key, key}).hidden.none()) << key;
  }
  EXPECT_TRUE(all.all());
}

TEST(ViewState, NumbersSetColoursThatAreAtHand) {
  EXPECT_EQ(pressed({"3"}).color, Color::kCurvature);
  EXPECT_EQ(pressed({"5"}).color, Color::kFeed);
  EXPECT_EQ(pressed({"4", "1"}).color, Color::kMargin) << "no design: no deviation";
}

TEST(ViewState, ViewKeysAimTheCameraAnewEachTime) {
  EXPECT_EQ(pressed({"t"}).view, View::kTop);
  EXPECT_EQ(pressed({"f"}).view, View::kFront);
  EXPECT_EQ(pressed({"s"}).view, View::kRight);
  EXPECT_EQ(pressed({"t", "i"}).view, View::kBest);
  EXPECT_EQ(pressed({"t", "t", "t"}).aims, 3);
}

TEST(ViewState, TheClipPlaneGoesThroughTheAxesAndMoves) {
  EXPECT_EQ(pressed({"x"}).clip.axis, 0);
  EXPECT_EQ(pressed({"x", "x", "x"}).clip.axis, 2);
  EXPECT_EQ(pressed({"x", "x", "x", "x"}).clip.axis, -1);
  EXPECT_GT(pressed({"x", "Up"}).clip.share, 0.5);
  EXPECT_NEAR(pressed({"x", "Up", "Down"}).clip.share, 0.5, 1e-12);
  EXPECT_FALSE(pressed({"x", "X"}).clip.keeps_low);
  EXPECT_EQ(pressed({"x", "Up", "0"}).clip, ClipPlane{});
}

TEST(ViewState, BracketsSpreadTheGhosts) {
  const auto wide = pressed({"bracketright"}), wider = pressed({"bracketright", "bracketright"});
  ASSERT_TRUE(wide.ghost_step_mm && wider.ghost_step_mm);
  EXPECT_GT(*wider.ghost_step_mm, *wide.ghost_step_mm);
  EXPECT_LT(*pressed({"bracketleft"}, wider).ghost_step_mm, *wider.ghost_step_mm);
  EXPECT_TRUE(pressed({"g", "bracketright"}).shows(Layer::kGhosts)) << "asked for, so shown";
}

TEST(ViewState, TabGoesThroughTheStripsAndEscapeLeavesThem) {
  EXPECT_EQ(pressed({"Tab"}).selection, (Selection{Part::kStrip, 0, -1}));
  EXPECT_EQ(pressed({"Tab", "Tab"}).selection.strip, 1);
  EXPECT_EQ(pressed({"Tab", "Tab", "Tab"}).selection.strip, 0);
  EXPECT_EQ(pressed({"Tab", "Escape"}).selection, Selection{});
}

TEST(ViewState, HelpOpensAndClosesWithoutTouchingTheRest) {
  for (const char* key : {"h", "question", "F1"}) EXPECT_TRUE(pressed({key}).help) << key;
  const ViewState back = pressed({"Tab", "h", "Escape"});
  EXPECT_FALSE(back.help);
  EXPECT_EQ(back.selection.strip, 0);
}

TEST(ViewState, OnlyQCloses) {
  EXPECT_TRUE(pressed({"q"}).closed);
  EXPECT_FALSE(pressed({"Escape", "e", "w", "F12", ""}).closed);
}

TEST(ViewState, SeekGoesToAShareOfTheWholeTime) {
  EXPECT_DOUBLE_EQ(after_seek({}, two_strips(), 0.25).time_s, 2);
  EXPECT_DOUBLE_EQ(after_seek({}, two_strips(), -3).time_s, 0);
  EXPECT_DOUBLE_EQ(after_seek({}, two_strips(), 7).time_s, 8);
}

TEST(ViewState, ASecondClickOnAStripSelectsThePoseThatCutThere) {
  const Picked strip{{Part::kStrip, 1, -1}, 2};
  const ViewState once = after_pick({}, two_strips(), strip);
  EXPECT_EQ(once.selection, strip.selection);
  EXPECT_DOUBLE_EQ(once.time_s, 0);
  const ViewState twice = after_pick(once, two_strips(), strip);
  EXPECT_EQ(twice.selection, (Selection{Part::kPose, 1, 2}));
  EXPECT_DOUBLE_EQ(twice.time_s, 6);
  EXPECT_EQ(after_pick(twice, two_strips(), {}).selection, Selection{});
}

TEST(ViewState, ADesignAloneHasNoTimeAndNoStrips) {
  ViewState state;
  for (const char* key :
       {"space", "Left", "Right", "Prior", "Next", "Home", "End", "Tab", "1", "2", "u", "x"})
    state = after_key(state, {}, key);
  EXPECT_DOUBLE_EQ(state.time_s, 0);
  EXPECT_FALSE(state.playing);
  EXPECT_EQ(state.selection, Selection{});
}

}  // namespace
}  // namespace hotblade::pipeline::preview
