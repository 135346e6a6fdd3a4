#include "pipeline/cli/ends_on_signal.hpp"

#include <unistd.h>

#include <chrono>
#include <utility>

namespace hotblade::pipeline {

EndsOnSignal::EndsOnSignal(const Console& console, std::string said, TakeBack take_back)
    : console_(console),
      said_(std::move(said)),
      take_back_(std::move(take_back)),
      watcher_([this] { watch(); }) {}

EndsOnSignal::~EndsOnSignal() {
  {
    const std::scoped_lock lock(mutex_);
    over_ = true;
  }
  changed_.notify_all();
  watcher_.join();
}

// A handler may not wake a thread, so the thread looks.
void EndsOnSignal::watch() {
  constexpr std::chrono::milliseconds kLook(20);
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, kLook, [this] { return over_ || interrupted(); })) {
  }
  // The lock is held to the end: the work cannot go on past the destructor meanwhile.
  if (over_ || !take_back_()) return;
  console_.warn(said_);
  // Threads are at work: nothing of theirs may be destroyed.
  ::_exit(static_cast<int>(Exit::kInterrupted));
}

}  // namespace hotblade::pipeline
