// Runs a loop on all cores that the caller may use.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

#include "gpu/backend/stop.hpp"

namespace hotblade::gpu {

// Calls each(i) for i from 0 to n - 1; a thread takes at least half of `block` of them in a row. Throws what
// `each` throws, and Stopped.
template <typename Each>
void for_each_in_blocks(std::size_t n, std::size_t block, const Each& each) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, block), [&](const auto& range) {
    stop_point();
    for (std::size_t i = range.begin(); i != range.end(); ++i) each(i);
  });
  stop_point();
}

}  // namespace hotblade::gpu
