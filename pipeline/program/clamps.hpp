// Both clamps of a blade in the design frame.
#pragma once

#include <span>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

using robot::ClampPoses;

// Returns the poses of the clamps that hold the blade in the frame's plane: axes are the tangent from A to B,
// the in-plane normal and the plane's normal.
[[nodiscard]] ClampPoses clamps(const elastica::Elastica& blade, const Frame& frame);
[[nodiscard]] std::vector<ClampPoses> clamps(std::span<const elastica::Elastica> blades,
                                             std::span<const Frame> frames);
// Returns the distance from the block to the nearer clamp, mm; 0 when a clamp is inside.
[[nodiscard]] double clamp_clearance_mm(const ClampPoses& clamps, const Block& block);

}  // namespace hotblade::pipeline
