// The planes that swept plans are tried with, and the side of the design that is waste.
#pragma once

#include <span>
#include <vector>

#include "pipeline/plan/sweep/sweep_sections.hpp"
#include "pipeline/settings/settings.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::pipeline {

// Of the area's mean normal towards z: a design that leans less is upright.
inline constexpr double kLeastLean = 0.1;

// +1 where the waste lies on the faces' front, -1 behind them; 0 where the design is upright and `keep` says
// nothing about it.
[[nodiscard]] double waste_side(const surface::TriangleMesh& mesh, Keep keep);

// Returns for each of these planes the share of the area behind all seams that is too steep for them
// (kMaxSlopeRad). Of a triangle across a seam, its corners and its middle count.
[[nodiscard]] std::vector<double> too_steep_shares(const WasteSurface& surface,
                                                   const std::vector<SweepSeam>& seams,
                                                   std::span<const surface::PlaneFamily> planes);

// The planes that the settings ask for, or else parallel ones along the design's borders, the least steep
// ones, all over a hemisphere, and the least steep ones of those that hold the least bend, no two within 3
// degrees that both are not too steep, in the design's own axes; then fans. Where the design turns too far
// for parallel planes along the least bend, a fan is along it. Throws surface::FanError where the fan's axis
// does not go with the design.
[[nodiscard]] std::vector<surface::PlaneFamily> sweep_planes(const surface::TriangleMesh& mesh,
                                                             const SliceSettings& settings);

}  // namespace hotblade::pipeline
