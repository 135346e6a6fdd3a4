// Runs a loop on all cores that the caller may use.
#pragma once

#include <cstddef>
#include <functional>

namespace hotblade::gpu {

// Calls run(first, end) for blocks that together are 0 .. n - 1 and no longer than `block`, on many threads.
// Throws what `run` throws, and Stopped.
void for_each_block(std::size_t n, std::size_t block,
                    const std::function<void(std::size_t, std::size_t)>& run);

// Calls each(i) for i from 0 to n - 1, so many in a row on one thread.
template <typename Each>
void for_each_in_blocks(std::size_t n, std::size_t block, const Each& each) {
  for_each_block(n, block, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) each(i);
  });
}

}  // namespace hotblade::gpu
