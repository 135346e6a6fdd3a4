// Both arms before a strip begins: from the straight blade in their jaws to its first shape, as robot
// programs bring it there (pipeline/program/straight_start.hpp).
#pragma once

#include <array>
#include <optional>

#include "pipeline/plan/arms/strip_clearance.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/verify/refusal.hpp"
#include "robot/arm/cell.hpp"

namespace hotblade::pipeline {

// Returns what stands in the way of arms that hold the strip's first pose as `how` says, by clamp: out of
// reach, a joint's margin, next to singular, or not proved clear. Absent: nothing. Of `held` the first joints
// count.
[[nodiscard]] std::optional<Refusal> start_refusal(const Strip& strip, const robot::BladeSection& blade,
                                                   const robot::Cell& cell, const HeldJoints& held,
                                                   const std::array<HeldClamp, 2>& how);

}  // namespace hotblade::pipeline
