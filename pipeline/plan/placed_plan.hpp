// A plan as its program alone tells it, to be measured again where arms have changed what it cuts.
#pragma once

#include "pipeline/plan/plan.hpp"

namespace hotblade::pipeline {

// Returns whether a program whose poses are those of another but for their times cuts something else: where
// the melted band depends on the speed, and a hot blade is slower or faster by more than controllers are
// told.
[[nodiscard]] bool cuts_otherwise(const Program& program, const Program& before);

// Returns what measure_again() asks of a plan. What weight, clamps and seams add is known of the whole alone,
// by the error budget, and stands for the same of each strip.
[[nodiscard]] PlanResult plan_of(Program program);

}  // namespace hotblade::pipeline
