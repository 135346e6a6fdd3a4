// Runs loops over many elements of a mesh on all cores.
#pragma once

#include <cstddef>
#include <functional>

namespace hotblade::surface {

// Items of a block in loops that do little for each.
inline constexpr std::size_t kBlock = 1 << 16;

// Calls body(first, last) once for each block of `size` of `count` items (the last may have fewer), side by
// side. The blocks are the same whatever the number of threads. The loop always runs to its end: what ends
// the work around it does not reach into it, so that its results may be used. Throws what a body throws.
void for_blocks(std::size_t count, std::size_t size,
                const std::function<void(std::size_t, std::size_t)>& body);

// Calls all of them, side by side, and returns when all have returned. Throws what one of them throws.
void side_by_side(const std::function<void()>& one, const std::function<void()>& other);

}  // namespace hotblade::surface
