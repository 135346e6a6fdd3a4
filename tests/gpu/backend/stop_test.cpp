#include "gpu/backend/stop.hpp"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace hotblade::gpu {
namespace {

// Loops within loops, without an end of their own.
void work_for_ever(std::atomic<int>& rounds) {
  for (;;) {
    tbb::parallel_for(0, 8, [&](int) {
      tbb::parallel_for(0, 8, [&](int) {
        stop_point();
        ++rounds;
      });
    });
  }
}

TEST(Stop, EndsLoopsOnAllThreadsFromAnother) {
  for (const int threads : {1, 4}) {
    Stop stop;
    std::atomic<int> rounds = 0;
    std::thread caller([&] {
      while (rounds < 1000) std::this_thread::yield();
      stop.ask();
    });
    EXPECT_THROW(run_stoppable(threads, stop, [&] { work_for_ever(rounds); }), Stopped);
    caller.join();
  }
}

TEST(Stop, EndsNoWorkButItsOwn) {
  Stop other, stop;
  other.ask();
  int rounds = 0;
  EXPECT_NO_THROW(run_stoppable(2, stop, [&] {
    for (; rounds < 1000; ++rounds) tbb::parallel_for(0, 8, [&](int) { stop_point(); });
  }));
  EXPECT_EQ(rounds, 1000);
}

// Threads that helped keep the mark of their work now and then, so many times.
TEST(Stop, IsOverWithItsWork) {
  Stop stop;
  stop.ask();
  for (int round = 0; round < 500; ++round) {
    EXPECT_THROW(run_stoppable(4, stop, [] { tbb::parallel_for(0, 1000, [](int) { stop_point(); }); }),
                 Stopped);
    EXPECT_FALSE(stop_asked());
    EXPECT_NO_THROW(tbb::parallel_for(0, 1000, [](int) { stop_point(); }));
  }
}

TEST(Stop, OfWorkHoldsAfterWorkWithinIt) {
  Stop outer, inner;
  run_stoppable(2, outer, [&] {
    run_stoppable(2, inner, [&] { inner.ask(); });
    EXPECT_FALSE(stop_asked());
    outer.ask();
    EXPECT_TRUE(stop_asked());
  });
  EXPECT_FALSE(stop_asked());
}

TEST(Stop, LetsWhatTheWorkThrowsThrough) {
  const Stop stop;
  EXPECT_THROW(run_stoppable(2, stop, [] { throw std::runtime_error("a reason"); }), std::runtime_error);
}

}  // namespace
}  // namespace hotblade::gpu
