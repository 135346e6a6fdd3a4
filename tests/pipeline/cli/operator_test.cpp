// What starts the arms at a terminal, and what does not.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "pipeline/cli/operator_answer.hpp"
#include "pipeline/cli/run_dialogue.hpp"
#include "pipeline/cli/shell_word.hpp"
#include "tests/pipeline/cli/simulated_cell.hpp"
#include "tests/pipeline/cli/terminal.hpp"
#include "tests/pipeline/motion_program.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

using testing::events;
using ::testing::HasSubstr;
using testing::Terminal;

TEST(OperatorAnswer, OnlyYesOrTheStripsIdStart) {
  for (const char* yes : {"yes", "S003"}) {
    EXPECT_TRUE(agrees_to_start(yes, "S003")) << yes;
  }
  for (const char* no :
       {"",       " ",   "n",   "no",  "y",    "ye",   "yess",  "S004",  "S00",  "start", "yes no",
        "\x1b[A", "YES", "Yes", "yES", " yes", "yes ", "yes\t", "yes\r", "yes.", "s003",  "S003 "}) {
    EXPECT_FALSE(agrees_to_start(no, "S003")) << no;
  }
}

// A question that is added needs a test of its own here, and a line in the table of docs/commands.md.
TEST(OperatorQuestions, AreThoseThatAreTestedBelow) {
  const std::filesystem::path room = hotblade::testing::source_dir() + "/pipeline/cli";
  std::vector<std::string> asked;
  for (const auto& file : std::filesystem::directory_iterator(room)) {
    std::istringstream text(testing::read_bytes(file.path()));
    for (std::string line; std::getline(text, line);) {
      if (line.find(" ask(") != std::string::npos &&
          line.find("std::optional<std::string> ask(") == std::string::npos)
        asked.push_back(file.path().filename());
    }
  }
  // Before a strip; a recovery chosen by option, and by word; after a restart of the controller.
  EXPECT_THAT(asked, ::testing::ElementsAre("cmd_run.cpp", "cmd_run.cpp", "cmd_run.cpp", "cmd_run.cpp"));
}

// By a shell itself.
TEST(ShellWords, ComeBackAsTheyWere) {
  EXPECT_EQ(shell_word("out/program.json"), "out/program.json");
  EXPECT_EQ(shell_word("127.0.0.1:1502"), "127.0.0.1:1502");
  EXPECT_EQ(shell_word("a b"), "'a b'");
  EXPECT_EQ(shell_word(""), "''");
  const std::vector<std::string> words{"out \xc3\xbc x/program.json",
                                       "it's",
                                       "$HOME",
                                       "`id`",
                                       "a;b&c|d",
                                       "*",
                                       "~",
                                       "#no",
                                       "\"q\"",
                                       "back\\slash",
                                       "two\nlines",
                                       "",
                                       "v\xff",
                                       "-x"};
  testing::TemporaryDirectory directory;
  const auto said = directory / "said";
  const std::string line = "printf '%s\\0' " + shell_line(words) + " > " + shell_word(said.string());
  Terminal shell("/bin/sh", {"-c", line});
  ASSERT_EQ(shell.wait(), 0) << shell.shown();
  std::string wanted;
  for (const std::string& word : words) wanted += word + '\0';
  EXPECT_EQ(testing::read_bytes(said), wanted);
}

class OperatorAtATerminal : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(file_) << to_json(testing::motion_program(2, 400));
    cell_.start({"--time-scale", "max"});
  }

  [[nodiscard]] robot::protocol::Status status() const { return cell_.now().status; }
  [[nodiscard]] std::vector<std::string> run() const {
    return {"run", file_.string(), "--connect", cell_.place(), "--progress", "none"};
  }

  testing::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "program.json";
  testing::SimulatedCell cell_;
};

// What a hand may do at a question, other than to agree: letters, a paste, arrows, a yes that is taken back
// or wiped out, Ctrl-D in an empty line and after a word without Enter, Ctrl-C, Ctrl-Z.
const std::vector<std::string> kNoAnswers{"n\n",
                                          "\n",
                                          "no\n",
                                          "y\n",
                                          "yess\n",
                                          "S00\n",
                                          "YES\n",
                                          " yes \n",
                                          "yes\t\n",
                                          "s001\n",
                                          "S002 yes\n",
                                          "yes no\n",
                                          "\x1b[A\n",
                                          "\x04",
                                          "yes\x04\x04",
                                          "\x03",
                                          "yes\x03",
                                          "yes\x7f\n",
                                          "yes\x15\n",
                                          "yes\x1a\n",
                                          std::string(10000, 'y') + "\n",
                                          std::string("yes\0\n", 5)};

TEST_F(OperatorAtATerminal, NothingButYesOrTheIdStarts) {
  for (const std::string& answer : kNoAnswers) {
    Terminal terminal(run());
    ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
    EXPECT_THAT(terminal.shown(), HasSubstr("the controller is IDLE"));
    ASSERT_TRUE(terminal.type(answer));
    EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
    EXPECT_THAT(terminal.shown(), HasSubstr("strip S001 not started")) << answer;
    EXPECT_EQ(status().executed, 0u) << answer;
  }
}

// The rest of a line that was begun before the question is no answer to it.
TEST_F(OperatorAtATerminal, AYesThatWasBegunBeforeTheQuestionDoesNotStart) {
  Terminal terminal(run());
  ASSERT_TRUE(terminal.type("yes"));
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  ASSERT_TRUE(terminal.type("\n"));
  EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
  EXPECT_EQ(status().executed, 0u);
}

TEST_F(OperatorAtATerminal, HowToGoOnIsSaidForAShell) {
  const auto odd = directory_ / "out \xc3\xbc x";
  std::filesystem::create_directory(odd);
  std::filesystem::rename(file_, odd / "program.json");
  file_ = odd / "program.json";
  Terminal terminal(run());
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  ASSERT_TRUE(terminal.type("n\n"));
  EXPECT_EQ(terminal.wait(), 130);
  EXPECT_THAT(terminal.shown(), HasSubstr("to go on: hotblade run '" + file_.string() + "' --connect " +
                                          cell_.place() + " --strip S001"));
}

TEST_F(OperatorAtATerminal, ATerminalThatIsGoneDoesNotStart) {
  for (const std::string typed : {"", "yes"}) {
    Terminal terminal(run());
    ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
    ASSERT_TRUE(terminal.type(typed));
    EXPECT_NE(terminal.hang_up(), 0);
    EXPECT_EQ(status().executed, 0u);
    EXPECT_EQ(status().state, robot::protocol::State::kIdle);
  }
}

TEST_F(OperatorAtATerminal, NothingButYesOrTheIdGoesOnWithAStripThatIsHeld) {
  const auto log = directory_ / "execution.jsonl";
  cell_.start({"--time-scale", "5", "--log", log.string()});
  {
    Terminal first(run());
    ASSERT_TRUE(first.shows("to start, anything else stops: ")) << first.shown();
    ASSERT_TRUE(first.type("yes\n"));
    ASSERT_TRUE(cell_.until([](const auto& now) { return now.status.executed > 120; }));
    ASSERT_TRUE(first.type("\x03"));
    ASSERT_EQ(first.wait(), 130) << first.shown();
  }
  ASSERT_TRUE(cell_.until([](const auto& now) { return now.status.state == robot::protocol::State::kHeld; }));
  const auto stood = status();
  ASSERT_LT(stood.executed, 400u);
  auto words = run();
  words.emplace_back("--resume");
  for (const std::string& answer : kNoAnswers) {
    Terminal terminal(words);
    ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
    EXPECT_THAT(terminal.shown(),
                HasSubstr("It is half cut: " + std::to_string(stood.executed) + " of 400 waypoints"));
    ASSERT_TRUE(terminal.type(answer));
    EXPECT_EQ(terminal.wait(), 130) << answer;
    EXPECT_EQ(status().executed, stood.executed) << answer;
    EXPECT_EQ(status().state, robot::protocol::State::kHeld) << answer;
  }
  EXPECT_EQ(events(log, "resume"), 0);
  Terminal terminal(words);
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  ASSERT_TRUE(terminal.type("S001\n"));
  ASSERT_TRUE(terminal.shows("strip S002: blade")) << terminal.shown();
  EXPECT_EQ(events(log, "exec"), 400) << "each waypoint once";
}

// ^V quotes it, where the terminal would make another end of line of it.
TEST_F(OperatorAtATerminal, ACarriageReturnBelongsToTheEndOfTheLine) {
  for (const std::string answer : {"yes\x16\r\n", "S001\x16\r\n"}) {
    Terminal terminal(run());
    ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
    ASSERT_TRUE(terminal.type(answer));
    EXPECT_TRUE(terminal.shows("S001 400 of 400 waypoints executed")) << terminal.shown();
    ASSERT_TRUE(terminal.shows("to start, anything else stops: ", 2)) << terminal.shown();
    ASSERT_TRUE(terminal.type("\n"));
    EXPECT_EQ(terminal.wait(), 130);
  }
}

TEST_F(OperatorAtATerminal, WhereQuestionsCannotBeSeenNothingStarts) {
  // The terminal's shell sends them to a file.
  const std::string command = hotblade::testing::binary_dir() + "/hotblade run '" + file_.string() +
                              "' --connect " + cell_.place() + " 2> '" + (directory_ / "said.txt").string() +
                              "'";
  Terminal shell("/bin/sh", {"-c", command});
  EXPECT_EQ(shell.wait(), 2);
  EXPECT_THAT(testing::read_bytes(directory_ / "said.txt"),
              HasSubstr("no terminal to show the questions on"));
}

TEST_F(OperatorAtATerminal, WhatWasTypedDuringOneStripDoesNotStartTheNext) {
  Terminal terminal(run());
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  // The answer, and before anybody was asked again two lines that would start the second strip.
  ASSERT_TRUE(terminal.type("yes\nyes\nS002\n"));
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ", 2)) << terminal.shown();
  ASSERT_TRUE(terminal.type("n\n"));
  EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("S001 400 of 400 waypoints executed"));
  EXPECT_THAT(terminal.shown(), HasSubstr("strip S002 not started"));
}

TEST_F(OperatorAtATerminal, YesOrTheIdStartEachStrip) {
  Terminal terminal(run());
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  ASSERT_TRUE(terminal.type("yes\n"));
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ", 2)) << terminal.shown();
  ASSERT_TRUE(terminal.type("S002\n"));
  EXPECT_EQ(terminal.wait(), 0) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("S002 400 of 400 waypoints executed"));
}

// The controller knows nothing of the job any more, but the block is cut as far as it said.
TEST_F(OperatorAtATerminal, WhatWasExecutedIsSaidWhenTheControllerLostItsLog) {
  cell_.start({"--time-scale", "5"});
  auto words = run();
  words.emplace_back("--yes");
  Terminal terminal(words);
  ASSERT_TRUE(cell_.until([](const auto& now) { return now.status.executed > 120; }));
  cell_.restart();
  EXPECT_EQ(terminal.wait(), 6) << terminal.shown();
  const std::string shown = terminal.shown();
  const auto at = shown.find(" of 400 waypoints executed, run 1");
  ASSERT_NE(at, std::string::npos) << shown;
  EXPECT_GT(std::stoi(shown.substr(shown.rfind(' ', at - 1))), 100) << shown;
}

// A simulator stops in the cut; the next `run --reset` finds the strip half cut.
class HalfCut : public OperatorAtATerminal {
 protected:
  void SetUp() override {
    OperatorAtATerminal::SetUp();
    // 20 s of motion, hot from 5 s to 15 s.
    cell_.start({"--time-scale", "20", "--log", log_.string(), "--fault", "estop@8"});
    Terminal terminal(run());
    ASSERT_TRUE(terminal.shows("anything else stops: ")) << terminal.shown();
    ASSERT_TRUE(terminal.type("yes\n"));
    ASSERT_EQ(terminal.wait(), 6) << terminal.shown();
    ASSERT_THAT(terminal.shown(), HasSubstr("ESTOP"));
    executed_ = status().executed;
    ASSERT_GT(executed_, 100u);
  }
  [[nodiscard]] std::vector<std::string> reset() const {
    auto words = run();
    words.insert(words.end(), {"--reset", "--strip", "S001"});
    return words;
  }

  std::filesystem::path log_ = directory_ / "execution.jsonl";
  std::uint32_t executed_ = 0;
};

// A yes would move nothing.
TEST_F(HalfCut, NothingIsAskedBeforeTheReset) {
  Terminal terminal(run());
  EXPECT_EQ(terminal.wait(), 6) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("the controller is in ESTOP [S001, "));
  EXPECT_THAT(terminal.shown(), HasSubstr(": see to the cell, then reset with --reset"));
  EXPECT_THAT(terminal.shown(), ::testing::Not(HasSubstr("anything else stops")));
}

TEST_F(HalfCut, IsSaidAndNothingMovesWithoutAChoice) {
  std::vector<std::string> answers = kNoAnswers;
  answers.insert(answers.end(), {"yes\n", "S001\n", "start\n", "withdraw", "withdraw\x04\x04"});
  for (const std::string& answer : answers) {
    Terminal terminal(reset());
    // Before the question is asked; it answers nothing.
    ASSERT_TRUE(terminal.type("withdraw\nrestart\n"));
    ASSERT_TRUE(terminal.shows("anything else stops: ")) << terminal.shown();
    EXPECT_THAT(terminal.shown(), HasSubstr("strip S001 was left half cut: " + std::to_string(executed_) +
                                            " of 400 waypoints"));
    ASSERT_TRUE(terminal.type(answer == "withdraw" ? "withdraw\x03" : answer));
    EXPECT_EQ(terminal.wait(), 130) << answer;
    EXPECT_THAT(terminal.shown(), HasSubstr("nothing was moved")) << answer;
    EXPECT_EQ(status().executed, executed_);
    EXPECT_TRUE(status().left_in_cut);
  }
  EXPECT_EQ(events(log_, "resume") + events(log_, "withdraw") + events(log_, "release"), 0);
}

TEST_F(HalfCut, WithdrawDrawsTheBladeBackAndEndsTheStrip) {
  Terminal terminal(reset());
  ASSERT_TRUE(terminal.shows("anything else stops: ")) << terminal.shown();
  ASSERT_TRUE(terminal.type("withdraw\n"));
  EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("withdrawn: the blade stands where the strip began, cold"));
  EXPECT_EQ(events(log_, "withdrawn"), 1);
  EXPECT_EQ(status().executed, executed_);
  EXPECT_FALSE(status().left_in_cut);
}

TEST_F(HalfCut, RestartGoesOnWithTheSameBlockToTheEnd) {
  Terminal terminal(reset());
  ASSERT_TRUE(terminal.shows("anything else stops: ")) << terminal.shown();
  ASSERT_TRUE(terminal.type("restart\n"));
  EXPECT_EQ(terminal.wait(), 0) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("S001 400 of 400 waypoints executed"));
  EXPECT_EQ(events(log_, "reenter"), 1);
  EXPECT_EQ(events(log_, "exec"), 400) << "each waypoint once";
}

TEST_F(HalfCut, GivenUpNothingMovesAndTheStripStartsAnew) {
  {
    Terminal terminal(reset());
    ASSERT_TRUE(terminal.shows("anything else stops: ")) << terminal.shown();
    ASSERT_TRUE(terminal.type("give up\n"));
    EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
    EXPECT_THAT(terminal.shown(), HasSubstr("free the blade and take the block out"));
  }
  EXPECT_EQ(events(log_, "resume") + events(log_, "withdraw"), 0);
  Terminal terminal(reset());
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  ASSERT_TRUE(terminal.type("yes\n"));
  EXPECT_EQ(terminal.wait(), 0) << terminal.shown();
}

TEST_F(HalfCut, WithRecoverAYesIsAskedFor) {
  auto words = reset();
  words.insert(words.end(), {"--recover", "withdraw"});
  {
    std::vector<std::string> answers = kNoAnswers;
    answers.insert(answers.end(), {"S001\n", "withdraw\n"});
    for (const std::string& answer : answers) {
      Terminal terminal(words);
      ASSERT_TRUE(terminal.shows("Type yes to withdraw, anything else stops: ")) << terminal.shown();
      ASSERT_TRUE(terminal.type(answer));
      EXPECT_EQ(terminal.wait(), 130) << answer;
      EXPECT_EQ(events(log_, "withdraw"), 0) << answer;
    }
  }
  Terminal terminal(words);
  ASSERT_TRUE(terminal.shows("Type yes to withdraw, anything else stops: ")) << terminal.shown();
  ASSERT_TRUE(terminal.type("yes\n"));
  EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
  EXPECT_EQ(events(log_, "withdrawn"), 1);
}

TEST_F(OperatorAtATerminal, AfterARestartOfTheControllerMotionWaits) {
  const auto log = directory_ / "execution.jsonl";
  std::vector<std::string> answers = kNoAnswers;
  answers.emplace_back("yes\n");
  for (const std::string& answer : answers) {
    std::filesystem::remove(log);
    cell_.start({"--time-scale", "20", "--log", log.string(), "--fault", "reboot@150"});
    Terminal terminal(run());
    ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
    // With lines that answer nothing, since the restart is yet to come.
    ASSERT_TRUE(terminal.type("yes\nyes\nS001\n"));
    ASSERT_TRUE(terminal.shows("to go on, anything else stops: ")) << terminal.shown();
    EXPECT_THAT(terminal.shown(), HasSubstr("strip S001: the controller was restarted after "));
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    EXPECT_EQ(events(log, "resume"), 0) << "it waits";
    ASSERT_TRUE(terminal.type(answer));
    if (answer == "yes\n") {
      ASSERT_TRUE(terminal.shows("strip S002: ")) << terminal.shown();
      EXPECT_EQ(events(log, "exec"), 400);
    } else {
      EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
      EXPECT_EQ(events(log, "resume"), 0);
    }
  }
}

TEST_F(OperatorAtATerminal, AYesIsForTheControllerThatWasAskedAbout) {
  const auto log = directory_ / "execution.jsonl";
  cell_.start({"--time-scale", "20", "--log", log.string()});
  Terminal terminal(run());
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  cell_.restart();
  ASSERT_TRUE(terminal.type("yes\n"));
  const std::string again = "to go on, anything else stops: ";
  ASSERT_TRUE(terminal.shows(again)) << terminal.shown();
  EXPECT_EQ(events(log, "start"), 0);
  ASSERT_TRUE(terminal.type("yes\n"));
  ASSERT_TRUE(cell_.until([](const auto& now) { return now.status.executed > 150; }));
  cell_.restart();
  ASSERT_TRUE(terminal.shows(again, 2)) << terminal.shown();
  // Twice, and the second time while nothing but STATUS is read of it.
  cell_.restart();
  ASSERT_TRUE(terminal.type("yes\n"));
  ASSERT_TRUE(terminal.shows(again, 3)) << terminal.shown();
  EXPECT_EQ(events(log, "resume"), 0);
  ASSERT_TRUE(terminal.type("yes\n"));
  ASSERT_TRUE(terminal.shows("strip S002: ")) << terminal.shown();
  EXPECT_EQ(events(log, "resume"), 1);
  EXPECT_EQ(events(log, "exec"), 400) << "each waypoint once";
}

TEST_F(OperatorAtATerminal, AStripThatWasCutMeanwhileIsNotAskedAbout) {
  cell_.start({"--time-scale", "20"});
  {
    Terminal left(run());
    ASSERT_TRUE(left.shows("to start, anything else stops: ")) << left.shown();
    ASSERT_TRUE(left.type("yes\n"));
    // All of the strip is with the controller, and 20 s of it pass in 1.
    ASSERT_TRUE(cell_.until([](const auto& now) { return now.status.accepted == 400; }));
    left.kill();
  }
  auto words = run();
  words.emplace_back("--resume");
  ASSERT_TRUE(cell_.until([](const auto& now) { return now.status.executed == 400; }));
  Terminal terminal(words);
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("strip S001: all 400 waypoints were executed meanwhile"));
  EXPECT_THAT(terminal.shown(), HasSubstr("strip S002: blade"));
}

TEST_F(OperatorAtATerminal, ALostLinkIsShownAtOnce) {
  cell_.start({"--time-scale", "1"});
  auto words = run();
  words.back() = "bar";
  Terminal terminal(words);
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  ASSERT_TRUE(terminal.type("yes\n"));
  ASSERT_TRUE(terminal.shows("S001 RUNNING")) << terminal.shown();
  const auto lost = std::chrono::steady_clock::now();
  cell_.kill();
  ASSERT_TRUE(terminal.shows("S001 link lost, trying again, 0 s")) << terminal.shown();
  EXPECT_LT(std::chrono::steady_clock::now() - lost, std::chrono::seconds(3));
  EXPECT_TRUE(terminal.shows("S001 link lost, trying again, 2 s")) << terminal.shown();
}

TEST(OperatorAnswer, OnlyTheWholeWordChoosesARecovery) {
  EXPECT_EQ(recovery_named("withdraw"), Recovery::kWithdraw);
  EXPECT_EQ(recovery_named("restart"), Recovery::kRestart);
  EXPECT_EQ(recovery_named("give up"), Recovery::kGiveUp);
  EXPECT_EQ(recovery_named("give-up"), Recovery::kGiveUp);
  for (const char* other :
       {"", "w", "yes", "give", "withdraw restart", "S001", " withdraw", "restart\r", "Restart"})
    EXPECT_FALSE(recovery_named(other)) << other;
}

}  // namespace
}  // namespace hotblade::pipeline
