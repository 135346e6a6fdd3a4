#include "pipeline/plan/motion/blocks.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "gpu/backend/stop.hpp"

namespace hotblade::pipeline {

void in_blocks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work) {
  // A few rounds of the widest lanes; a strip of some thousand poses still makes enough blocks for all cores.
  constexpr std::size_t kBlock = 128;
  const std::size_t blocks = (count + kBlock - 1) / kBlock;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    gpu::stop_point();
    work(b * kBlock, std::min(count, (b + 1) * kBlock));
  });
  gpu::stop_point();
}

}  // namespace hotblade::pipeline
