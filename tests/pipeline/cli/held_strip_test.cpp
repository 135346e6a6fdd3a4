// A strip that is held: `run --recover` ends it or goes on with it, and cuts nothing that it is not told to.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "pipeline/program/strip_jobs.hpp"
#include "robot/controller/execution_log.hpp"
#include "tests/pipeline/cli/simulated_cell.hpp"
#include "tests/pipeline/cli/terminal.hpp"
#include "tests/pipeline/motion_program.hpp"

namespace hotblade::pipeline {
namespace {

using robot::protocol::State;
using testing::Ended;
using testing::events;
using ::testing::HasSubstr;
using testing::hotblade;
using testing::Process;
using testing::Terminal;

// 20 s of motion, hot from 5 s to 15 s, five times as fast.
class HeldStrip : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(file_) << to_json(testing::motion_program(2, 400));
    cell_.start({"--time-scale", "5", "--log", log_.string()});
  }
  [[nodiscard]] std::vector<std::string> run(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"run", file_.string(), "--connect", cell_.place(), "--progress", "none"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  [[nodiscard]] Ended recover(const std::string& word, std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--yes", "--recover", word});
    return hotblade(run(more));
  }
  [[nodiscard]] robot::protocol::Status status() const { return cell_.now().status; }
  // Ctrl-C in the foam, or a client that dies there.
  void leave_half_cut(int signal = SIGINT) {
    Process first(run({"--yes"}));
    ASSERT_TRUE(cell_.until([](const auto& now) { return now.status.executed > 120; }));
    ::kill(first.pid(), signal);
    first.wait();
    if (signal != SIGINT) return;
    ASSERT_EQ(status().state, State::kHeld);
    executed_ = status().executed;
    ASSERT_LT(executed_, 300u) << "still in the foam";
  }
  void expect_nothing_cut_on() {
    EXPECT_EQ(status().executed, executed_);
    EXPECT_EQ(events(log_, "exec"), static_cast<int>(executed_));
    EXPECT_EQ(events(log_, "resume") + events(log_, "retract"), 0);
  }
  // A line is on disk a moment after STATUS says what happened.
  [[nodiscard]] bool logged_once(const std::string& event) const {
    return cell_.until([&](const auto&) { return events(log_, event) == 1; });
  }
  [[nodiscard]] bool journal_is_there() const {
    return std::filesystem::exists(file_.string() + ".127.0.0.1-" + std::to_string(cell_.port()) + ".resume");
  }

  testing::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "program.json", log_ = directory_ / "execution.jsonl";
  testing::SimulatedCell cell_;
  std::uint32_t executed_ = 0;
};

TEST_F(HeldStrip, IsGivenUpAndNothingMoves) {
  for (const bool resume : {false, true}) {
    leave_half_cut();
    const auto ended =
        recover("give-up", resume ? std::vector<std::string>{"--resume"} : std::vector<std::string>{});
    EXPECT_EQ(ended.code, 130) << ended.err;
    EXPECT_THAT(ended.err,
                HasSubstr("strip S001 is held under way: " + std::to_string(executed_) + " of 400"));
    EXPECT_THAT(ended.err, HasSubstr("given up: free the blade"));
    expect_nothing_cut_on();
    EXPECT_EQ(status().state, State::kIdle);
    EXPECT_FALSE(status().left_in_cut);
    EXPECT_TRUE(logged_once("release"));
    EXPECT_EQ(events(log_, "withdraw"), 0);
    EXPECT_FALSE(journal_is_there()) << "the strip is over";
    const auto again = recover("give-up");
    EXPECT_EQ(again.code, 6);
    EXPECT_THAT(again.err, HasSubstr("no strip of this program is held or left half cut there"));
    const auto gone_on = hotblade(run({"--yes", "--resume"}));
    EXPECT_EQ(gone_on.code, 6);
    EXPECT_THAT(gone_on.err, HasSubstr("strip S001 was given up"));
    expect_nothing_cut_on();
    cell_.kill();
    std::filesystem::remove(log_);
    cell_.start({"--time-scale", "5", "--log", log_.string()});
  }
}

// Before the foam no blade is to be freed.
TEST_F(HeldStrip, BeforeTheFoamItIsGivenUpToo) {
  cell_.start({"--time-scale", "1", "--log", log_.string()});
  {
    Process first(run({"--yes"}));
    ASSERT_TRUE(cell_.until([](const auto& now) { return now.status.executed > 10; }));
    ::kill(first.pid(), SIGINT);
    first.wait();
  }
  executed_ = status().executed;
  ASSERT_LT(executed_, 100u);
  EXPECT_EQ(recover("give-up").code, 130);
  expect_nothing_cut_on();
  EXPECT_EQ(status().state, State::kIdle);
  EXPECT_TRUE(logged_once("reset"));
  EXPECT_EQ(events(log_, "release"), 0);
}

TEST_F(HeldStrip, IsWithdrawnColdAndStartsAnew) {
  leave_half_cut();
  const auto ended = recover("withdraw", {"--resume"});
  EXPECT_EQ(ended.code, 130) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("withdrawn: the blade stands where the strip began, cold"));
  EXPECT_TRUE(logged_once("withdrawn"));
  EXPECT_EQ(events(log_, "exec"), static_cast<int>(executed_));
  EXPECT_EQ(events(log_, "resume"), 0);
  EXPECT_EQ(status().state, State::kIdle);
  EXPECT_FALSE(journal_is_there());
  const auto anew = hotblade(run({"--yes", "--strip", "S001"}));
  EXPECT_EQ(anew.code, 0) << anew.err;
}

TEST_F(HeldStrip, IsGoneOnWithWithoutResume) {
  leave_half_cut();
  const auto ended = recover("restart");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("S002 400 of 400"));
  EXPECT_EQ(events(log_, "exec"), 800) << "each waypoint once";
}

TEST_F(HeldStrip, OfAClientThatIsGoneIsWaitedForUntilItStands) {
  leave_half_cut(SIGKILL);
  const auto ended = recover("give-up");
  EXPECT_EQ(ended.code, 130) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("waiting until its watchdog has held it"));
  EXPECT_TRUE(logged_once("held"));
  EXPECT_EQ(events(log_, "resume"), 0);
  EXPECT_EQ(status().state, State::kIdle);
  EXPECT_FALSE(status().left_in_cut);
}

TEST_F(HeldStrip, WhatCannotBeRecoveredStartsNothing) {
  for (const char* word : {"withdraw", "give-up"}) {
    const auto nothing = recover(word);
    EXPECT_EQ(nothing.code, 6);
    EXPECT_THAT(nothing.err,
                HasSubstr(std::string("--recover ") + word + ": no strip of this program is held"));
  }
  EXPECT_EQ(events(log_, "open"), 0);
  leave_half_cut();
  const auto other_strip = recover("give-up", {"--strip", "S002"});
  EXPECT_EQ(other_strip.code, 6);
  EXPECT_THAT(other_strip.err, HasSubstr("strip S001 is held, not S002"));
  const auto unsaid = hotblade(run({"--yes"}));
  EXPECT_EQ(unsaid.code, 6);
  EXPECT_THAT(unsaid.err, HasSubstr("--resume takes it over, --recover withdraw or give-up ends it"));
  const auto other = directory_ / "other.json";
  std::ofstream(other) << to_json(testing::motion_program(2, 300));
  const auto foreign =
      hotblade({"run", other.string(), "--connect", cell_.place(), "--yes", "--recover", "give-up"});
  EXPECT_EQ(foreign.code, 6);
  EXPECT_THAT(foreign.err,
              HasSubstr("another program's job is held there (" + robot::to_hex(status().job_id)));
  std::this_thread::sleep_for(std::chrono::milliseconds(5100));  // the lease
  const auto in_the_way = hotblade({"run", other.string(), "--connect", cell_.place(), "--yes"});
  EXPECT_EQ(in_the_way.code, 6);
  EXPECT_THAT(in_the_way.err, HasSubstr("run that job's program with --resume to go on, or with --recover"));
  EXPECT_EQ(status().state, State::kHeld);
  expect_nothing_cut_on();
  cell_.estop();
  const auto latched = recover("give-up");
  EXPECT_EQ(latched.code, 6);
  EXPECT_THAT(latched.err, HasSubstr("the controller is in ESTOP"));
  EXPECT_THAT(latched.err, HasSubstr("reset with --reset"));
  const auto after = recover("give-up", {"--reset"});
  EXPECT_EQ(after.code, 130) << after.err;
  expect_nothing_cut_on();
}

TEST_F(HeldStrip, WithRecoverAYesIsAskedFor) {
  leave_half_cut();
  for (const std::string answer : {"n\n", "\n", "S001\n", "give up\n", "yes\x03", "\x04"}) {
    Terminal terminal(run({"--recover", "give-up"}));
    ASSERT_TRUE(terminal.shows("Type yes to give-up, anything else stops: ")) << terminal.shown();
    EXPECT_THAT(terminal.shown(), HasSubstr("strip S001 is held under way: "));
    ASSERT_TRUE(terminal.type(answer));
    EXPECT_EQ(terminal.wait(), 130) << answer;
    EXPECT_THAT(terminal.shown(), HasSubstr("nothing was moved")) << answer;
    EXPECT_EQ(status().state, State::kHeld) << answer;
  }
  Terminal terminal(run({"--recover", "give-up"}));
  ASSERT_TRUE(terminal.shows("Type yes to give-up, anything else stops: ")) << terminal.shown();
  ASSERT_TRUE(terminal.type("yes\n"));
  EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("given up"));
  EXPECT_EQ(status().state, State::kIdle);
  expect_nothing_cut_on();
}

}  // namespace
}  // namespace hotblade::pipeline
