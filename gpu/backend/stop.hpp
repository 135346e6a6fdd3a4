// Long work on many threads that its caller may end.
//
// Work that run_stoppable() runs asks stop_point() in its loops, at least every 100 ms; so the caller, on a
// thread that waits, ends it by a Stop without any of it knowing. Elsewhere a stop point does nothing.
//
// What a stop point throws ends the loops beside it too, and loops within those return without a word, their
// work half done: so one follows every parallel loop before its results are used
// (tests/house/check_stops.py).
#pragma once

#include <functional>

namespace hotblade::gpu {

// Thrown by a stop point where the work is to end; no error, and so no std::exception.
struct Stopped {};

// What ends one run of work. It has to outlive the run.
class Stop {
 public:
  Stop() = default;
  ~Stop();
  Stop(const Stop&) = delete;
  Stop& operator=(const Stop&) = delete;

  // Has the work end at its next stop points; from any thread.
  void ask();
};

// Runs work with so many threads (0: all cores), this one among them. Throws what the work throws, Stopped
// among it.
void run_stoppable(int threads, const Stop& stop, const std::function<void()>& work);

// Tells whether the work that this thread is at is to end: for loops through which nothing may be thrown.
[[nodiscard]] bool stop_asked();

// Throws Stopped where the work that this thread is at is to end.
void stop_point();

}  // namespace hotblade::gpu
