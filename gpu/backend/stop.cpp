#include "gpu/backend/stop.hpp"

#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include <atomic>
#include <mutex>
#include <set>

namespace hotblade::gpu {

namespace {

// The stop of the work that this thread is at; 0: none. A thread that has left the work may keep its number,
// which nobody asks to stop again.
thread_local std::uint64_t this_thread = 0;

std::atomic<std::uint64_t> last_number = 0;
std::atomic<int> asked_count = 0;
std::mutex asked_mutex;
std::set<std::uint64_t> asked;

// Tells every thread that comes to an arena which work it is at.
class Marks : public tbb::task_scheduler_observer {
 public:
  Marks(tbb::task_arena& arena, std::uint64_t number) : tbb::task_scheduler_observer(arena), number_(number) {
    observe(true);
  }
  ~Marks() override { observe(false); }
  Marks(const Marks&) = delete;
  Marks& operator=(const Marks&) = delete;

  void on_scheduler_entry(bool /*is_worker*/) override { this_thread = number_; }
  void on_scheduler_exit(bool /*is_worker*/) override { this_thread = 0; }

 private:
  std::uint64_t number_;
};

}  // namespace

Stop::Stop() : number_(++last_number) {}

Stop::~Stop() {
  const std::scoped_lock lock(asked_mutex);
  if (asked.erase(number_) > 0) --asked_count;
}

void Stop::ask() {
  const std::scoped_lock lock(asked_mutex);
  if (asked.insert(number_).second) ++asked_count;
}

void run_stoppable(int threads, const Stop& stop, const std::function<void()>& work) {
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  const Marks marks(arena, stop.number_);
  arena.execute(work);
}

bool stop_asked() {
  if (asked_count.load(std::memory_order_relaxed) == 0) return false;
  const std::scoped_lock lock(asked_mutex);
  return asked.contains(this_thread);
}

void stop_point() {
  if (stop_asked()) throw Stopped{};
}

}  // namespace hotblade::gpu
