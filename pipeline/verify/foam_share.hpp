// How much of a block's foam becomes the part.
#pragma once

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Returns the volume on the kept side of the blade's centre line over the volume of the block, 0 to 1, where
// the planned blade passes through it: the surface that the blade sweeps, cut into patches and held inside
// the block, and the prisms below them. Planes may turn. What is left to 1 is waste, the melted band
// included. 0 where no pose sweeps through the block.
[[nodiscard]] double foam_kept_share(const Strip& strip);

}  // namespace hotblade::pipeline
