#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "gpu/backend/stop.hpp"
#include "pipeline/settings/error.hpp"
#include "python/module.hpp"

namespace hotblade::python {
namespace {

// What the work and the thread that waits for it tell each other.
class Watch {
 public:
  void tell(const std::string& stage, double share) {
    const std::scoped_lock lock(mutex_);
    stage_ = stage;
    share_ = share;
    told_ = true;
  }
  void end(std::exception_ptr error) {
    {
      const std::scoped_lock lock(mutex_);
      error_ = std::move(error);
      ended_ = true;
    }
    changed_.notify_all();
  }
  // Waits for the end, a while; whether it came.
  bool ended_within(std::chrono::milliseconds while_ms) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, while_ms, [this] { return ended_; });
  }
  // Returns what was told since this was asked.
  std::optional<std::pair<std::string, double>> news() {
    const std::scoped_lock lock(mutex_);
    if (!std::exchange(told_, false)) return std::nullopt;
    return std::pair(stage_, share_);
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string stage_;
  double share_ = 0;
  bool told_ = false, ended_ = false;
  std::exception_ptr error_;
};

int counted(const py::object& threads) {
  constexpr int kMostThreads = 1024;  // as of --jobs: many more are no arena that TBB can make
  const std::int64_t count = whole_number(threads, "threads");
  if (count < 0 || count > kMostThreads)
    throw pipeline::Error(pipeline::ErrorKind::kBadSettings,
                          "threads (" + std::to_string(count) + ", must be 0 to " +
                              std::to_string(kMostThreads) + "): 0 takes all cores");
  return static_cast<int>(count);
}

}  // namespace

void run_watched(const py::object& threads, const py::object& progress,
                 const std::function<void(const Tell&)>& work) {
  const int count = counted(threads);
  if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0)
    throw_not("a function of stage and share", progress, "progress");
  constexpr std::chrono::milliseconds kWake(50);
  Watch watch;
  gpu::Stop stop;
  std::thread worker([&] {
    std::exception_ptr error;
    try {
      gpu::run_stoppable(count, stop, [&] {
        work([&](const std::string& stage, double share) {
          gpu::stop_point();
          watch.tell(stage, share);
        });
      });
    } catch (...) {
      error = std::current_exception();
    }
    watch.end(error);
  });
  try {
    for (bool ended = false; !ended;) {
      {
        const py::gil_scoped_release release;
        ended = watch.ended_within(kWake);
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      const auto news = watch.news();
      if (news && !progress.is_none()) progress(news->first, news->second);
    }
  } catch (...) {
    stop.ask();
    const py::gil_scoped_release release;
    worker.join();
    throw;
  }
  worker.join();
  watch.rethrow();
  if (!progress.is_none()) progress("done", 1.0);
}

}  // namespace hotblade::python
