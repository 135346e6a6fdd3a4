// A program run as a process of its own, under limits of time and memory, that does not outlive its parent.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hotblade::pipeline::batch {

struct ChildLimits {
  double seconds = 0;  // by the clock
  int megabytes = 0;   // of its data (RLIMIT_DATA)
};

struct ChildEnd {
  int exit_code = -1;  // where it ended by itself
  int signal = 0;      // that ended it
  bool out_of_time = false;
  double seconds = 0, cpu_s = 0, peak_mb = 0;
};

// What is added to the environment, or replaced in it.
using Variables = std::vector<std::pair<std::string, std::string>>;

class Child {
 public:
  // Starts words[0] with nothing to read, its stdout thrown away and its stderr in a file. A program that
  // cannot be started ends with exit code 127. The caller has to be the process's only thread but for
  // sleeping ones, and has to live as long as the child. Throws Error (kFile) when the file cannot be written
  // or no process can be made.
  Child(const std::vector<std::string>& words, const Variables& variables,
        const std::filesystem::path& stderr_file, const ChildLimits& limits);
  // Ends it, and those that it started, at once.
  ~Child();
  Child(Child&& other) noexcept;
  Child& operator=(Child&&) = delete;

  // A descriptor that can be read from when it has ended.
  [[nodiscard]] int descriptor() const { return descriptor_; }

  // Returns how it ended; absent while it runs. Ends it when its time is over.
  [[nodiscard]] std::optional<ChildEnd> poll();

 private:
  void kill() const;

  pid_t pid_ = -1;
  int descriptor_ = -1;
  double seconds_ = 0;
  std::chrono::steady_clock::time_point start_;
  bool out_of_time_ = false;
};

}  // namespace hotblade::pipeline::batch
