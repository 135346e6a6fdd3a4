// What the blades next to the one that was chosen for a strip come to: why it was this length.
#pragma once

#include <optional>

#include "pipeline/plan/ribs/strip_plan.hpp"
#include "pipeline/verify/refusal.hpp"

namespace hotblade::pipeline {

// A free length at a strip's ribs.
struct BladeTrial {
  double length_mm = 0;
  Refusal refusal;    // the limit that stops it; kNone: none does
  double sag_mm = 0;  // what weight moves the cut, where no limit stops it
};

// The chosen length, and the next ones of blade.free_lengths_mm; absent where the list ends.
struct BladeTrials {
  BladeTrial chosen;
  std::optional<BladeTrial> shorter, longer;
};

// Returns what choose_blade (blade.hpp) finds of the chosen length and its neighbours on the strip's ribs.
[[nodiscard]] BladeTrials try_other_blades(const StripPlan& strip, const Settings& settings);

}  // namespace hotblade::pipeline
