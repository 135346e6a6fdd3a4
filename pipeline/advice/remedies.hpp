// The settings that would make a refused job cuttable, with numbers, where the plan's own figures tell them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"

namespace hotblade::pipeline {

// A setting and the value at which refusals of this plan would hold: a guess, worth a try
// (pipeline/advice/advice.hpp).
struct Remedy {
  std::string setting;  // "design.tolerance_mm"
  std::string now, needed;
  std::string why;           // how the number was found, and what to look at then
  std::size_t refusals = 0;  // settled by it
  double value = 0;          // needed, as a number
};

// Returns the settings with the remedy's value: a longer blade beside those at hand, every edge of the block
// at least as long.
[[nodiscard]] Settings with_remedy(Settings settings, const Remedy& remedy);

// Returns the same change as `--set` takes it: "design.tolerance_mm=1.3".
[[nodiscard]] std::string assignment_of(const Settings& settings, const Remedy& remedy);

// The remedies of a plan, in the order of its refusals: one a setting, the most demanding of the refusals it
// settles. The numbers are this plan's: planned anew, other ribs are chosen and other limits may show.
// Refusals that no number settles (a snap, a crossing) have only their hint.
[[nodiscard]] std::vector<Remedy> remedies(const PlanResult& result);

}  // namespace hotblade::pipeline
