#include "pipeline/plan/motion/other_blades.hpp"

#include <algorithm>

#include "pipeline/plan/motion/blade.hpp"

namespace hotblade::pipeline {

namespace {

BladeTrial trial_of(const StripPlan& strip, Settings settings, double length_mm) {
  settings.blade.free_lengths_mm = {length_mm};
  // The sag is the last thing that is looked at: where none may be, its refusal says how much there is.
  const BladeReport report = choose_blade(strip.ribs, strip, strip.block, settings, 0);
  if (report.choice) return {length_mm, {}, 0};
  if (report.refusal.limit == Limit::kSag) return {length_mm, {}, report.refusal.value};
  return {length_mm, report.refusal, 0};
}

}  // namespace

BladeTrials try_other_blades(const StripPlan& strip, const Settings& settings) {
  const std::vector<double>& lengths = settings.blade.free_lengths_mm;
  BladeTrials trials{trial_of(strip, settings, strip.blade_length_mm), {}, {}};
  const auto own = std::lower_bound(lengths.begin(), lengths.end(), strip.blade_length_mm);
  if (own != lengths.begin()) trials.shorter = trial_of(strip, settings, *(own - 1));
  const auto next = std::upper_bound(lengths.begin(), lengths.end(), strip.blade_length_mm);
  if (next != lengths.end()) trials.longer = trial_of(strip, settings, *next);
  return trials;
}

}  // namespace hotblade::pipeline
