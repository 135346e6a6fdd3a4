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
  double fails = 0;          // now, as a number: what the refusal was with
  double step = 1;           // the smallest change of the value that is told apart
  std::string unit;          // of the value; empty: it has none
};

// Returns the settings with the remedy's value: a longer blade beside those at hand, every edge of the block
// at least as long.
[[nodiscard]] Settings with_remedy(Settings settings, const Remedy& remedy);

// Returns the same change as `--set` takes it: "design.tolerance_mm=1.3".
[[nodiscard]] std::string assignment_of(const Settings& settings, const Remedy& remedy);

// Returns how many steps lie between the remedy's value, 0 steps away, and one that fails, the last of them.
[[nodiscard]] std::size_t steps_between(const Remedy& remedy, double fails);

// Returns the remedy with its value so many steps nearer to the one that fails.
[[nodiscard]] Remedy at_step(Remedy remedy, double fails, std::size_t steps);

// The remedies of a plan, in the order of its refusals: one a setting, the most demanding of the refusals it
// settles. The numbers are this plan's: planned anew, other ribs are chosen and other limits may show.
// Refusals that no number settles (a snap, a crossing) have only their hint.
[[nodiscard]] std::vector<Remedy> remedies(const PlanResult& result);

}  // namespace hotblade::pipeline
