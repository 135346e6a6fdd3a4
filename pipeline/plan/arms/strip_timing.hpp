// A strip's times for the arms that hold its clamps: waypoints stay, and are met later where joints ask for
// it.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/plan/arms/strip_clearance.hpp"
#include "pipeline/plan/motion/slower.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/verify/refusal.hpp"
#include "robot/arm/cell.hpp"

namespace hotblade::pipeline {

// Returns the ways of the joints that hold the strip's clamps, with what the cell allows them and what the
// ramp of a hold adds.
[[nodiscard]] std::vector<LimitedWay> moving_joints(const robot::Cell& cell, const HeldJoints& held);

struct StripTiming {
  Slower slower;
  std::optional<Refusal> refusal;  // a joint would hold the cut back more than foam bears
};

// Returns times that keep what joints and clamps may do: those of the strip where they do.
[[nodiscard]] StripTiming time_for_arms(const Strip& strip, const MotionSettings& motion,
                                        const robot::Cell& cell, const HeldJoints& held);

}  // namespace hotblade::pipeline
