// Many poses on all cores allowed, in blocks that fill the lanes of elastica/blade/blade_batch.hpp.
#pragma once

#include <cstddef>
#include <functional>

namespace hotblade::pipeline {

// Calls work(from, to) for consecutive blocks of 0 .. count, side by side. Where blocks begin does not depend
// on the number of threads.
void in_blocks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work);

}  // namespace hotblade::pipeline
