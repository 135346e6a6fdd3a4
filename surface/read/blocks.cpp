#include "surface/read/blocks.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace hotblade::surface {

void for_blocks(std::size_t count, std::size_t size,
                const std::function<void(std::size_t, std::size_t)>& body) {
  if (count <= size) {
    if (count > 0) body(0, count);
    return;
  }
  // A thread that waits here takes up no other work: what called may hold something that it needs.
  tbb::this_task_arena::isolate([&] {
    tbb::task_group_context apart(tbb::task_group_context::isolated);
    tbb::parallel_for(
        std::size_t{0}, (count + size - 1) / size,
        [&](std::size_t block) { body(block * size, std::min(count, (block + 1) * size)); },
        tbb::auto_partitioner(), apart);
  });
}

void side_by_side(const std::function<void()>& one, const std::function<void()>& other) {
  tbb::this_task_arena::isolate([&] {
    tbb::task_group_context apart(tbb::task_group_context::isolated);
    tbb::parallel_invoke(one, other, apart);
  });
}

}  // namespace hotblade::surface
