// The way from the straight blade, as it is put into both jaws, to a strip's first shape: exact elastica
// whose curvature grows from none, so that the blade is bent and never buckled. Robot programs begin with it.
#pragma once

#include <vector>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Moves before waypoint 0 is reached, and what they take together, s: clamps move by centimetres.
inline constexpr int kStartMoves = 40;
inline constexpr double kStart_s = 4;

// Returns the poses from the straight blade to the strip's first, which is the last of them with its time;
// the others have frame, blade, clamps and times below that.
[[nodiscard]] std::vector<BladePose> straight_start(const Strip& strip);

}  // namespace hotblade::pipeline
