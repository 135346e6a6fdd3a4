// Finds the order in which points are best answered: neighbours one after the other.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace hotblade::gpu {

// Returns a permutation of the points along a space-filling curve (Morton order), or nothing when they
// already follow each other closely enough for that to gain nothing. Every point is finite.
[[nodiscard]] std::vector<std::uint32_t> coherent_order(std::span<const Eigen::Vector3d> points);

}  // namespace hotblade::gpu
