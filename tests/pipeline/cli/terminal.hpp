// `hotblade` at a terminal of its own: what it shows, and a hand that types.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "tests/paths.hpp"

namespace hotblade::pipeline::testing {

class Terminal {
 public:
  // `words` without the program's name.
  explicit Terminal(const std::vector<std::string>& words)
      : Terminal(hotblade::testing::binary_dir() + "/hotblade", words) {}
  Terminal(const std::string& program, std::vector<std::string> words) {
    words.insert(words.begin(), program);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = ::forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (pid_ == 0) {
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
    ::fcntl(terminal_, F_SETFD, FD_CLOEXEC);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal() {
    kill();
    if (terminal_ >= 0) ::close(terminal_);
  }

  // Whether all of it went in.
  bool type(const std::string& text) const {
    return ::write(terminal_, text.data(), text.size()) == static_cast<ssize_t>(text.size());
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

  // The exit code, with all that was shown in shown(); -1 for a program that is silent for long and is
  // killed.
  int wait() {
    while (read_more()) {
    }
    if (silent_) {
      kill();
      return -1;
    }
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  // The terminal is closed, as by a window or a connection that goes. The exit code, or 128 and the signal.
  int hang_up() {
    ::close(terminal_);
    terminal_ = -1;
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  // As the power does that goes out.
  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }

  [[nodiscard]] const std::string& shown() const { return shown_; }

 private:
  bool read_more() {
    constexpr int kPatience_ms = 60000;
    pollfd readable{terminal_, POLLIN, 0};
    silent_ = ::poll(&readable, 1, kPatience_ms) <= 0;
    if (silent_) return false;
    char bytes[4096];
    ssize_t n = ::read(terminal_, bytes, sizeof bytes);
    if (n < 0) {
      // The last words of a program that has ended may still be on their way through the terminal.
      ::usleep(100'000);
      n = ::read(terminal_, bytes, sizeof bytes);
    }
    if (n <= 0) return false;
    shown_.append(bytes, static_cast<std::size_t>(n));
    return true;
  }

  int terminal_ = -1;
  pid_t pid_ = -1;
  bool silent_ = false;
  std::string shown_;
};

}  // namespace hotblade::pipeline::testing
