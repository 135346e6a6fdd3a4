// Ends work that has written nothing within a moment of SIGINT or SIGTERM, whatever it computes.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "pipeline/cli/command.hpp"

namespace hotblade::pipeline {

// While it lives, a signal ends the program with Exit::kInterrupted: no loop has to ask for it. What the work
// has begun to write is taken back first.
class EndsOnSignal {
 public:
  // Takes back what was begun, from another thread than the work's; false where it is too late, and the work
  // goes on to its end.
  using TakeBack = std::function<bool()>;

  // `said` is the last line on stderr.
  EndsOnSignal(
      const Console& console, std::string said, TakeBack take_back = [] { return true; });
  // Returns only where no end is under way.
  ~EndsOnSignal();
  EndsOnSignal(const EndsOnSignal&) = delete;
  EndsOnSignal& operator=(const EndsOnSignal&) = delete;

 private:
  void watch();

  const Console& console_;
  std::string said_;
  TakeBack take_back_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool over_ = false;
  std::thread watcher_;
};

// Throws Error (kInterrupted) where a signal has come: for work that takes back itself what it has begun.
void expect_not_interrupted(const std::string& said);

}  // namespace hotblade::pipeline
