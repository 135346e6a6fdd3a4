// Both clamps of a blade in the design frame.
#pragma once

#include <span>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Clamp poses in the design frame: tangent from A to B, in-plane normal, plane normal.
struct ClampPair {
  Pose a, b;
};
[[nodiscard]] ClampPair clamps(const elastica::Elastica& blade, const Frame& frame);
[[nodiscard]] std::vector<ClampPair> clamps(std::span<const elastica::Elastica> blades,
                                            std::span<const Frame> frames);
// Of the nearer clamp from the block; 0 inside.
[[nodiscard]] double clamp_clearance_mm(const ClampPair& pair, const Stock& stock);

}  // namespace hotblade::pipeline
