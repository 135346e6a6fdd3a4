// A race on purpose: the thread sanitizer has to report it, or what it does not report says nothing.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdio>

int main() {
  std::size_t counted = 0;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, 64, 1),
                    [&](const auto& range) { counted += range.size(); });
  std::printf("counted %zu\n", counted);
  return 0;
}
