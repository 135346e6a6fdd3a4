// Finds chains that one blade could cut together, across the windows and notches between them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "surface/slice/slice.hpp"

namespace hotblade::surface {

// Returns the bridges of a graph, disjoint and in the order of their first chains. `joined` are pairs of
// chains with the same surface between two of their pieces in neighbouring sections, `spacing_mm` is the
// largest distance of the planes. Chains that hang together so make a bridge if in each section from the
// first to the last their pieces lie one after the other, the way across each gap ahead of both its ends, and
// if from section to section the outer ends move by twice the distance of the planes at most.
[[nodiscard]] std::vector<Bridge> find_bridges(const RibGraph& graph,
                                               std::span<const std::array<int, 2>> joined, double spacing_mm);

}  // namespace hotblade::surface
