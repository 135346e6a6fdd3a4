#include "gpu/backend/stop.hpp"

#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>

namespace hotblade::gpu {

namespace {

// The run of work that this thread is at; 0: none. A thread that has left the work may keep its number: the
// scheduler does not say of all threads that they leave. No later run has it.
thread_local std::uint64_t this_thread = 0;

// What is asked to stop and what runs, guarded by the mutex; the count is of what is asked.
std::atomic<int> asked_count = 0;
std::mutex asked_mutex;
std::set<const Stop*> asked;
std::uint64_t last_run = 0;
std::map<std::uint64_t, const Stop*> runs;

// Tells every thread that comes to an arena which work it is at.
class Marks : public tbb::task_scheduler_observer {
 public:
  Marks(tbb::task_arena& arena, std::uint64_t run) : tbb::task_scheduler_observer(arena), run_(run) {
    observe(true);
  }
  ~Marks() override { observe(false); }
  Marks(const Marks&) = delete;
  Marks& operator=(const Marks&) = delete;

  void on_scheduler_entry(bool /*is_worker*/) override { this_thread = run_; }
  void on_scheduler_exit(bool /*is_worker*/) override { this_thread = 0; }

 private:
  std::uint64_t run_;
};

// One run of work in the table, from its begin to its end.
class Run {
 public:
  explicit Run(const Stop& stop) : of_caller_(this_thread) {
    const std::scoped_lock lock(asked_mutex);
    number_ = ++last_run;
    runs.emplace(number_, &stop);
  }
  ~Run() {
    this_thread = of_caller_;
    const std::scoped_lock lock(asked_mutex);
    runs.erase(number_);
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  [[nodiscard]] std::uint64_t number() const { return number_; }

 private:
  std::uint64_t of_caller_;
  std::uint64_t number_ = 0;
};

}  // namespace

Stop::~Stop() {
  const std::scoped_lock lock(asked_mutex);
  if (asked.erase(this) > 0) --asked_count;
}

void Stop::ask() {
  const std::scoped_lock lock(asked_mutex);
  if (asked.insert(this).second) ++asked_count;
}

void run_stoppable(int threads, const Stop& stop, const std::function<void()>& work) {
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  const Run run(stop);
  const Marks marks(arena, run.number());
  arena.execute(work);
}

bool stop_asked() {
  if (asked_count.load(std::memory_order_relaxed) == 0) return false;
  const std::scoped_lock lock(asked_mutex);
  const auto run = runs.find(this_thread);
  return run != runs.end() && asked.contains(run->second);
}

void stop_point() {
  if (stop_asked()) throw Stopped{};
}

}  // namespace hotblade::gpu
