// What starts the arms at a terminal, and what does not.
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <memory>
#include <thread>

#include "pipeline/cli/operator_answer.hpp"
#include "pipeline/cli/run_dialogue.hpp"
#include "robot/client/client.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/motion_program.hpp"
#include "tests/pipeline/run_program.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;

TEST(OperatorAnswer, OnlyYesOrTheStripsIdStart) {
  for (const char* yes : {"yes", "YES", " yes \t", "yes\r", "S003", "s003"}) {
    EXPECT_TRUE(agrees_to_start(yes, "S003")) << yes;
  }
  for (const char* no : {"", " ", "n", "no", "y", "ye", "yess", "S004", "S00", "start", "yes no", "\x1b[A"}) {
    EXPECT_FALSE(agrees_to_start(no, "S003")) << no;
  }
}

std::uint16_t free_port() {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ::bind(fd, reinterpret_cast<const sockaddr*>(&address), size);
  ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(fd);
  return ntohs(address.sin_port);
}

// `hotblade run` at a terminal of its own: what it shows, and a hand that types.
class Terminal {
 public:
  explicit Terminal(std::vector<std::string> words) {
    words.insert(words.begin(), hotblade::testing::binary_dir() + "/hotblade");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = ::forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (pid_ == 0) {
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(terminal_);
  }

  void type(const std::string& text) const {
    EXPECT_EQ(::write(terminal_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  // Reads on until the text was shown `times` times; false when the program ends or is silent for long first.
  bool shows(const std::string& text, int times = 1) {
    const auto count = [&] {
      int found = 0;
      for (auto at = shown_.find(text); at != std::string::npos; at = shown_.find(text, at + 1)) ++found;
      return found;
    };
    while (count() < times) {
      if (!read_more()) return false;
    }
    return true;
  }

  // The exit code, with all that was shown in shown().
  int wait() {
    while (read_more()) {
    }
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  [[nodiscard]] const std::string& shown() const { return shown_; }

 private:
  bool read_more() {
    constexpr int kPatience_ms = 60000;
    pollfd readable{terminal_, POLLIN, 0};
    if (::poll(&readable, 1, kPatience_ms) <= 0) return false;
    char bytes[4096];
    const ssize_t n = ::read(terminal_, bytes, sizeof bytes);
    if (n <= 0) return false;
    shown_.append(bytes, static_cast<std::size_t>(n));
    return true;
  }

  int terminal_ = -1;
  pid_t pid_ = -1;
  std::string shown_;
};

class OperatorAtATerminal : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(file_) << to_json(testing::motion_program(2, 400));
    port_ = free_port();
    simulate({"--time-scale", "max"});
  }

  // A controller on a new port; a running one is killed.
  void simulate(const std::vector<std::string>& more) {
    sim_.reset();
    std::vector<std::string> words{"sim", "--listen", place()};
    words.insert(words.end(), more.begin(), more.end());
    sim_ = std::make_unique<testing::Program>(words);
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!now().reached && std::chrono::steady_clock::now() < patience) {
    }
    ASSERT_TRUE(now().reached);
  }

  [[nodiscard]] std::string place() const { return "127.0.0.1:" + std::to_string(port_); }
  [[nodiscard]] robot::ControllerSnapshot now() const {
    robot::StreamOptions options;
    options.port = port_;
    return robot::look(options);
  }
  [[nodiscard]] std::vector<std::string> run() const {
    return {"run", file_.string(), "--connect", place(), "--progress", "none"};
  }

  testing::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "program.json";
  std::uint16_t port_ = 0;
  std::unique_ptr<testing::Program> sim_;
};

TEST_F(OperatorAtATerminal, NStartsNothing) {
  for (const std::string answer : {"n", "", "no", "y"}) {
    Terminal terminal(run());
    ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
    EXPECT_THAT(terminal.shown(), HasSubstr("the controller is IDLE"));
    terminal.type(answer + "\n");
    EXPECT_EQ(terminal.wait(), 130);
    EXPECT_THAT(terminal.shown(), HasSubstr("strip S001 not started")) << answer;
    EXPECT_EQ(now().status.executed, 0u) << answer;
  }
}

TEST_F(OperatorAtATerminal, WhatWasTypedDuringOneStripDoesNotStartTheNext) {
  Terminal terminal(run());
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  // The answer, and before anybody was asked again two lines that would start the second strip.
  terminal.type("yes\nyes\nS002\n");
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ", 2)) << terminal.shown();
  terminal.type("n\n");
  EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("S001 400 of 400 waypoints executed"));
  EXPECT_THAT(terminal.shown(), HasSubstr("strip S002 not started"));
}

TEST_F(OperatorAtATerminal, YesOrTheIdStartEachStrip) {
  Terminal terminal(run());
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  terminal.type("yes\n");
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ", 2)) << terminal.shown();
  terminal.type("S002\n");
  EXPECT_EQ(terminal.wait(), 0) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("S002 400 of 400 waypoints executed"));
}

// What the log of the simulator has of an event.
int events(const std::filesystem::path& log, const std::string& event) {
  const std::string text = testing::read_bytes(log);
  const std::string wanted = "{\"ev\":\"" + event + "\"";
  int found = 0;
  for (auto at = text.find(wanted); at != std::string::npos; at = text.find(wanted, at + 1)) ++found;
  return found;
}

// A simulator stops in the cut; the next `run --reset` finds the strip half cut.
class HalfCut : public OperatorAtATerminal {
 protected:
  void SetUp() override {
    OperatorAtATerminal::SetUp();
    // 20 s of motion, hot from 5 s to 15 s.
    simulate({"--time-scale", "20", "--log", log_.string(), "--fault", "estop@8"});
    Terminal terminal(run());
    ASSERT_TRUE(terminal.shows("anything else stops: ")) << terminal.shown();
    terminal.type("yes\n");
    ASSERT_EQ(terminal.wait(), 6) << terminal.shown();
    ASSERT_THAT(terminal.shown(), HasSubstr("ESTOP"));
    executed_ = now().status.executed;
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

TEST_F(HalfCut, IsSaidAndNothingMovesWithoutAChoice) {
  for (const std::string answer : {"", "n", "yes", "S001", "start"}) {
    Terminal terminal(reset());
    ASSERT_TRUE(terminal.shows("anything else stops: ")) << terminal.shown();
    EXPECT_THAT(terminal.shown(), HasSubstr("strip S001 was left half cut: " + std::to_string(executed_) +
                                            " of 400 waypoints"));
    terminal.type(answer + "\n");
    EXPECT_EQ(terminal.wait(), 130) << answer;
    EXPECT_THAT(terminal.shown(), HasSubstr("nothing was moved")) << answer;
    EXPECT_EQ(now().status.executed, executed_);
    EXPECT_TRUE(now().status.left_in_cut);
  }
  EXPECT_EQ(events(log_, "resume") + events(log_, "withdraw") + events(log_, "release"), 0);
}

TEST_F(HalfCut, WithdrawDrawsTheBladeBackAndEndsTheStrip) {
  Terminal terminal(reset());
  ASSERT_TRUE(terminal.shows("anything else stops: ")) << terminal.shown();
  terminal.type("withdraw\n");
  EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("withdrawn: the blade stands where the strip began, cold"));
  EXPECT_EQ(events(log_, "withdrawn"), 1);
  EXPECT_EQ(now().status.executed, executed_);
  EXPECT_FALSE(now().status.left_in_cut);
}

TEST_F(HalfCut, RestartGoesOnWithTheSameBlockToTheEnd) {
  Terminal terminal(reset());
  ASSERT_TRUE(terminal.shows("anything else stops: ")) << terminal.shown();
  terminal.type("restart\n");
  EXPECT_EQ(terminal.wait(), 0) << terminal.shown();
  EXPECT_THAT(terminal.shown(), HasSubstr("S001 400 of 400 waypoints executed"));
  EXPECT_EQ(events(log_, "reenter"), 1);
  EXPECT_EQ(events(log_, "exec"), 400) << "each waypoint once";
}

TEST_F(HalfCut, GivenUpNothingMovesAndTheStripStartsAnew) {
  {
    Terminal terminal(reset());
    ASSERT_TRUE(terminal.shows("anything else stops: ")) << terminal.shown();
    terminal.type("give up\n");
    EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
    EXPECT_THAT(terminal.shown(), HasSubstr("free the blade and take the block out"));
  }
  EXPECT_EQ(events(log_, "resume") + events(log_, "withdraw"), 0);
  Terminal terminal(reset());
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  terminal.type("yes\n");
  EXPECT_EQ(terminal.wait(), 0) << terminal.shown();
}

TEST_F(HalfCut, WithRecoverAYesIsAskedFor) {
  auto words = reset();
  words.insert(words.end(), {"--recover", "withdraw"});
  {
    Terminal terminal(words);
    ASSERT_TRUE(terminal.shows("Type yes to withdraw, anything else stops: ")) << terminal.shown();
    terminal.type("n\n");
    EXPECT_EQ(terminal.wait(), 130);
    EXPECT_EQ(events(log_, "withdraw"), 0);
  }
  Terminal terminal(words);
  ASSERT_TRUE(terminal.shows("Type yes to withdraw, anything else stops: ")) << terminal.shown();
  terminal.type("yes\n");
  EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
  EXPECT_EQ(events(log_, "withdrawn"), 1);
}

TEST_F(OperatorAtATerminal, AfterARestartOfTheControllerMotionWaits) {
  const auto log = directory_ / "execution.jsonl";
  for (const std::string answer : {"n", "yes"}) {
    std::filesystem::remove(log);
    simulate({"--time-scale", "20", "--log", log.string(), "--fault", "reboot@150"});
    Terminal terminal(run());
    ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
    terminal.type("yes\n");
    ASSERT_TRUE(terminal.shows("to go on, anything else stops: ")) << terminal.shown();
    EXPECT_THAT(terminal.shown(), HasSubstr("strip S001: the controller was restarted after "));
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    EXPECT_EQ(events(log, "resume"), 0) << "it waits";
    terminal.type(answer + "\n");
    if (answer == "n") {
      EXPECT_EQ(terminal.wait(), 130) << terminal.shown();
      EXPECT_EQ(events(log, "resume"), 0);
    } else {
      ASSERT_TRUE(terminal.shows("strip S002: ")) << terminal.shown();
      EXPECT_EQ(events(log, "exec"), 400);
    }
  }
}

TEST_F(OperatorAtATerminal, ALostLinkIsShownAtOnce) {
  simulate({"--time-scale", "1"});
  auto words = run();
  words.back() = "bar";
  Terminal terminal(words);
  ASSERT_TRUE(terminal.shows("to start, anything else stops: ")) << terminal.shown();
  terminal.type("yes\n");
  ASSERT_TRUE(terminal.shows("S001 RUNNING")) << terminal.shown();
  const auto lost = std::chrono::steady_clock::now();
  sim_.reset();
  ASSERT_TRUE(terminal.shows("S001 link lost, trying again, 0 s")) << terminal.shown();
  EXPECT_LT(std::chrono::steady_clock::now() - lost, std::chrono::seconds(3));
  EXPECT_TRUE(terminal.shows("S001 link lost, trying again, 2 s")) << terminal.shown();
}

TEST(OperatorAnswer, OnlyTheWholeWordChoosesARecovery) {
  EXPECT_EQ(recovery_named(" withdraw\r"), Recovery::kWithdraw);
  EXPECT_EQ(recovery_named("restart"), Recovery::kRestart);
  EXPECT_EQ(recovery_named("give up"), Recovery::kGiveUp);
  EXPECT_EQ(recovery_named("give-up"), Recovery::kGiveUp);
  for (const char* other : {"", "w", "yes", "give", "withdraw restart", "S001"})
    EXPECT_FALSE(recovery_named(other)) << other;
}

}  // namespace
}  // namespace hotblade::pipeline
