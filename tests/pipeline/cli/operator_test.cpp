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
    sim_ = std::make_unique<testing::Program>(
        std::vector<std::string>{"sim", "--listen", place(), "--time-scale", "max"});
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

}  // namespace
}  // namespace hotblade::pipeline
