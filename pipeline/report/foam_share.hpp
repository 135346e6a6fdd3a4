// How much of a block's foam becomes the part.
#pragma once

#include "pipeline/program.hpp"

namespace hotblade::pipeline {

// The volume on the kept side of the blade's centre line over the volume of the block, 0 to 1, as the planned
// blade passes through it: the area below the blade in every pose's plane (Green's theorem on the blade's
// curve, held inside the block's section), by trapezoids along the sweep. What is left to 1 is waste, the
// melted band included. 0 where no two poses lie in the block.
[[nodiscard]] double foam_kept_share(const Strip& strip);

}  // namespace hotblade::pipeline
