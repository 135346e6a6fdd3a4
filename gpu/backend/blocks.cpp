#include "gpu/backend/blocks.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "gpu/backend/stop.hpp"

namespace hotblade::gpu {

void for_each_block(std::size_t n, std::size_t block,
                    const std::function<void(std::size_t, std::size_t)>& run) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (n + block - 1) / block), [&](const auto& range) {
    for (std::size_t k = range.begin(); k != range.end(); ++k) {
      stop_point();
      run(k * block, std::min(n, (k + 1) * block));
    }
  });
  stop_point();
}

}  // namespace hotblade::gpu
