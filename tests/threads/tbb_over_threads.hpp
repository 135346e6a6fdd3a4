// What hotblade uses of oneTBB, over std::thread, for the thread sanitizer: it sees neither how libtbb's
// scheduler hands over a task nor how it waits for one, since Debian's library is built without it, and would
// call every hand-over a race. Here all of it is instrumented. Work is dealt out in turn, so that each thread
// has some however fast the first is: the sanitizer tells races between threads, and none within one.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <iterator>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace tbb {
namespace over_threads {

// Threads that one call takes, on machines of one core too; calls inside others add theirs.
inline constexpr std::size_t kThreads = 4;
// Beyond so many threads at once calls do their work themselves.
inline constexpr std::size_t kMostThreads = 32;

inline std::atomic<std::size_t> allowed{kThreads};
inline std::atomic<std::size_t> running{0};

// Keeps the first exception of several threads.
class FirstError {
 public:
  template <typename Work>
  void catching(const Work& work) {
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr error_;
};

// Calls each(i) for all i below n: thread t those with i % threads == t, the caller being thread 0.
template <typename Each>
void deal(std::size_t n, const Each& each) {
  std::size_t threads = std::min({n, allowed.load(), kThreads});
  if (running.load() + threads > kMostThreads) threads = 1;
  threads = std::max<std::size_t>(threads, 1);
  FirstError error;
  const auto share = [&](std::size_t first) {
    error.catching([&] {
      for (std::size_t i = first; i < n; i += threads) each(i);
    });
  };
  std::vector<std::thread> others;
  running += threads - 1;
  for (std::size_t t = 1; t < threads; ++t) others.emplace_back(share, t);
  share(0);
  for (std::thread& other : others) other.join();
  running -= threads - 1;
  error.rethrow();
}

}  // namespace over_threads

template <typename Value>
class blocked_range {
 public:
  using const_iterator = Value;
  blocked_range(Value begin, Value end, std::size_t grain = 1) : begin_(begin), end_(end), grain_(grain) {}
  [[nodiscard]] Value begin() const { return begin_; }
  [[nodiscard]] Value end() const { return end_; }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(end_ - begin_); }
  [[nodiscard]] std::size_t grainsize() const { return grain_; }
  [[nodiscard]] bool empty() const { return !(begin_ < end_); }

 private:
  Value begin_, end_;
  std::size_t grain_;
};

// Only max_allowed_parallelism is used; the last one alive counts.
class global_control {
 public:
  enum parameter { max_allowed_parallelism };
  global_control(parameter, std::size_t value) : before_(over_threads::allowed.exchange(value)) {}
  ~global_control() { over_threads::allowed = before_; }
  global_control(const global_control&) = delete;
  global_control& operator=(const global_control&) = delete;

 private:
  std::size_t before_;
};

namespace info {
inline int default_concurrency() {
  return static_cast<int>(over_threads::kThreads);
}
}  // namespace info

// The range in pieces of its grain or a little more, at most 64.
template <typename Value, typename Body>
void parallel_for(const blocked_range<Value>& range, const Body& body) {
  constexpr std::size_t kPieces = 64;
  const std::size_t n = range.size(), grain = std::max<std::size_t>(range.grainsize(), 1);
  const std::size_t pieces = std::min((n + grain - 1) / grain, kPieces);
  over_threads::deal(pieces, [&](std::size_t i) {
    const auto at = [&](std::size_t k) { return range.begin() + static_cast<Value>(n * k / pieces); };
    body(blocked_range<Value>(at(i), at(i + 1), grain));
  });
}

template <typename Index, typename Body>
void parallel_for(Index first, Index last, const Body& body) {
  const std::size_t n = first < last ? static_cast<std::size_t>(last - first) : 0;
  over_threads::deal(n, [&](std::size_t i) { body(first + static_cast<Index>(i)); });
}

template <typename... Works>
void parallel_invoke(const Works&... works) {
  const std::array<std::function<void()>, sizeof...(Works)> all{std::function<void()>(std::cref(works))...};
  over_threads::deal(all.size(), [&](std::size_t i) { all[i](); });
}

// Halves the range down to its grain: the same pieces and the same joins for any number of threads.
template <typename Value, typename Result, typename Over, typename Join>
Result parallel_deterministic_reduce(const blocked_range<Value>& range, const Result& identity,
                                     const Over& over, const Join& join) {
  if (range.size() <= range.grainsize()) return over(range, identity);
  const Value middle = range.begin() + (range.end() - range.begin()) / 2;
  std::array<Result, 2> halves{identity, identity};
  over_threads::deal(2, [&](std::size_t i) {
    const blocked_range<Value> half(i == 0 ? range.begin() : middle, i == 0 ? middle : range.end(),
                                    range.grainsize());
    halves[i] = parallel_deterministic_reduce(half, identity, over, join);
  });
  return join(halves[0], halves[1]);
}

template <typename Iterator, typename Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = {}) {
  const Iterator middle = begin + (end - begin) / 2;
  parallel_invoke([&] { std::sort(begin, middle, less); }, [&] { std::sort(middle, end, less); });
  std::inplace_merge(begin, middle, end, less);
}

class task_group {
 public:
  task_group() = default;
  task_group(const task_group&) = delete;
  task_group& operator=(const task_group&) = delete;
  ~task_group() { join(); }

  template <typename Work>
  void run(Work work) {
    threads_.emplace_back([this, work = std::move(work)] { error_.catching(work); });
  }
  void wait() {
    join();
    error_.rethrow();
  }

 private:
  void join() {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

  over_threads::FirstError error_;
  std::vector<std::thread> threads_;
};

}  // namespace tbb
