// Runs the hotblade program as a user would, and catches what it prints.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "tests/paths.hpp"
#include "tests/pipeline/temporary_directory.hpp"

extern char** environ;

namespace hotblade::pipeline::testing {

struct Ended {
  int code = -1;  // exit code; 128 + signal when it was killed
  std::string out, err;
};

// A hotblade process; killed when it is still there at the end of the scope.
class Process {
 public:
  // `args` without the program's name; the working directory is the caller's.
  explicit Process(const std::vector<std::string>& args) {
    std::vector<std::string> words{hotblade::testing::binary_dir() + "/hotblade"};
    words.insert(words.end(), args.begin(), args.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = (files_ / "out").string(), err = (files_ / "err").string();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
    const int failed = posix_spawn(&pid_, words[0].c_str(), &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) throw std::runtime_error("cannot start " + words[0]);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    (void)wait();
  }

  [[nodiscard]] pid_t pid() const { return pid_; }

  // Whether the text is on stderr by now.
  [[nodiscard]] bool printed_to_stderr(const std::string& text) const {
    return read_bytes(files_ / "err").find(text) != std::string::npos;
  }

  // Ends it as Ctrl-C or a service manager does.
  Ended stop() {
    ::kill(pid_, SIGTERM);
    return wait();
  }

  Ended wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return {code, read_bytes(files_ / "out"), read_bytes(files_ / "err")};
  }

 private:
  TemporaryDirectory files_;
  pid_t pid_ = -1;
};

inline Ended hotblade(const std::vector<std::string>& args) {
  return Process(args).wait();
}

}  // namespace hotblade::pipeline::testing
