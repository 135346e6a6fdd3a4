// Work that Python waits for, and what becomes of it where Python ends.
#include <cxxabi.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <set>
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

// TBB has no more threads than cores unless it is told, and warns of an arena that asks for more.
void allow(int threads) {
  static std::mutex mutex;
  static std::unique_ptr<tbb::global_control> most;
  static int allowed = tbb::info::default_concurrency();
  const std::scoped_lock lock(mutex);
  if (threads <= allowed) return;
  most.reset();  // of two controls the lesser holds
  most = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(threads));
  allowed = threads;
}

// Work on a thread of its own. Whoever waits for its end may stand still for ever: it is all who know it that
// keep it.
class Run {
 public:
  Run(int threads, const std::function<void(const Tell&)>& work) {
    allow(threads);
    thread_ = std::thread([this, threads, &work] {
      std::exception_ptr error;
      try {
        gpu::run_stoppable(threads, stop_, [&] {
          work([&](const std::string& stage, double share) {
            gpu::stop_point();
            watch_.tell(stage, share);
          });
        });
      } catch (...) {
        error = std::current_exception();
      }
      watch_.end(error);
    });
  }
  ~Run() { end(); }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  [[nodiscard]] Watch& watch() { return watch_; }
  void ask() { stop_.ask(); }
  // Waits until the thread has ended; from any thread.
  void end() {
    std::call_once(ended_, [this] { thread_.join(); });
  }

 private:
  Watch watch_;
  gpu::Stop stop_;
  std::once_flag ended_;
  std::thread thread_;
};

// All runs of the process, until Python ends.
class Runs {
 public:
  // Nothing where Python is about to end, but for what it calls itself then.
  std::shared_ptr<Run> begin(int threads, const std::function<void(const Tell&)>& work) {
    const std::scoped_lock lock(mutex_);
    if (ending_ && *ending_ != std::this_thread::get_id()) return nullptr;
    auto run = std::make_shared<Run>(threads, work);
    runs_.insert(run);
    return run;
  }
  void forget(const std::shared_ptr<Run>& run) {
    const std::scoped_lock lock(mutex_);
    runs_.erase(run);
  }
  // Ends all, and returns when they have ended.
  void end() {
    std::set<std::shared_ptr<Run>> runs;
    {
      const std::scoped_lock lock(mutex_);
      ending_ = std::this_thread::get_id();
      // The threads of a process are not those of its fork.
      if (process_ == ::getpid()) runs = runs_;
    }
    for (const auto& run : runs) run->ask();
    for (const auto& run : runs) run->end();
  }

 private:
  const pid_t process_ = ::getpid();
  std::mutex mutex_;
  std::optional<std::thread::id> ending_;
  std::set<std::shared_ptr<Run>> runs_;
};

Runs& all_runs() {
  static auto* const runs = new Runs;  // threads that stand still may know it to the end
  return *runs;
}

[[noreturn]] void throw_exit() {
  PyErr_SetNone(PyExc_SystemExit);
  throw py::error_already_set();
}

[[noreturn]] void stand_still() {
  for (;;) ::pause();
}

// No object of Python is on the way of a thread that is unwound within the call.
void call(const py::object& progress, const std::string& stage, double share) {
  PyObject* answer = nullptr;
  try {
    answer = PyObject_CallFunction(progress.ptr(), "sd", stage.c_str(), share);
  } catch (const abi::__forced_unwind&) {
    stand_still();
  }
  if (answer == nullptr) throw py::error_already_set();
  Py_DECREF(answer);
}

}  // namespace

Unlocked::~Unlocked() {
  try {
    PyEval_RestoreThread(state_);
  } catch (const abi::__forced_unwind&) {
    stand_still();
  }
}

void run_watched(const py::object& threads, const py::object& progress,
                 const std::function<void(const Tell&)>& work) {
  const int count = counted(threads);
  if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0)
    throw_not("a function of stage and share", progress, "progress");
  constexpr std::chrono::milliseconds kWake(50);
  const std::shared_ptr<Run> run = all_runs().begin(count, work);
  if (!run) throw_exit();
  Watch& watch = run->watch();
  try {
    for (bool ended = false; !ended;) {
      {
        const Unlocked release;
        ended = watch.ended_within(kWake);
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      const auto news = watch.news();
      if (news && !progress.is_none()) call(progress, news->first, news->second);
    }
  } catch (...) {
    run->ask();
    const Unlocked release;
    run->end();
    all_runs().forget(run);
    throw;
  }
  run->end();
  all_runs().forget(run);
  try {
    watch.rethrow();
  } catch (const gpu::Stopped&) {  // nobody else asked for it
    throw_exit();
  }
  if (!progress.is_none()) call(progress, "done", 1.0);
}

void add_watched(py::module_&) {
  py::module_::import("atexit").attr("register")(
      py::cpp_function([] { unlocked([] { all_runs().end(); }); }));
}

}  // namespace hotblade::python
