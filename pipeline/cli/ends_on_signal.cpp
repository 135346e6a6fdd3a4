#include "pipeline/cli/ends_on_signal.hpp"

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

namespace {

// A process is there until all of its threads have noticed its end, and some of libraries run only where
// nobody else does (Mesa's, which keep shaders on disk): seconds later on a busy machine.
void raise_priorities() {
  std::error_code error;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", error)) {
    const int thread = std::atoi(task.path().filename().c_str());
    const sched_param none{};
    (void)::sched_setscheduler(thread, SCHED_OTHER, &none);
    (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(thread), 0);
  }
}

}  // namespace

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

void expect_not_interrupted(const std::string& said) {
  if (interrupted()) throw Error(ErrorKind::kInterrupted, said);
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
  raise_priorities();
  // Threads are at work: nothing of theirs may be destroyed.
  ::_exit(static_cast<int>(Exit::kInterrupted));
}

}  // namespace hotblade::pipeline
