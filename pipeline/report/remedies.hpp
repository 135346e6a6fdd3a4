// The settings that would make a refused job cuttable, with numbers, where the plan's own figures tell them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"

namespace hotblade::pipeline {

// A setting and the value at which refusals of this plan would hold.
struct Remedy {
  std::string setting;  // "design.tolerance_mm"
  std::string now, needed;
  std::string why;           // how the number was found, and what to look at then
  std::size_t refusals = 0;  // settled by it
};

// The remedies of a plan, in the order of its refusals: one a setting, the most demanding of the refusals it
// settles. The numbers are this plan's: planned anew, other ribs are chosen and other limits may show.
// Refusals that no number settles (a snap, a crossing) have only their hint.
[[nodiscard]] std::vector<Remedy> remedies(const PlanResult& result);

}  // namespace hotblade::pipeline
