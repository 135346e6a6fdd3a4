// What would make a refused job cuttable, tried: the job is planned again with each change of settings that
// the plan's figures or the design's shape suggest, and a change is told only when that plan passed.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/advice/remedies.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/plan/suggestions.hpp"

namespace hotblade::pipeline {

// A change of settings.
struct SettingsChange {
  std::vector<std::string> assignments;  // as `--set` takes them: "design.tolerance_mm=1.3"
  std::string without;                   // the setting that is left out instead; empty: none
  std::string why;
  std::function<void(Settings&)> apply;
  std::optional<Remedy> remedy{};  // of a number
};

// Plans the job with other settings.
using PlanAgain = std::function<PlanResult(const Settings&)>;

// Returns the changes that the design's shape alone suggests (pipeline/plan/suggestions.hpp).
[[nodiscard]] std::vector<SettingsChange> changes_by_shape(const std::vector<Suggestion>& suggestions);

// Returns the changes that are likely to help, most likely first: those that the shape suggests, then of
// planes that were given, then of what stood in the way (pipeline/advice/remedies.hpp).
[[nodiscard]] std::vector<SettingsChange> likely_changes(const PlanResult& refused,
                                                         const std::vector<Suggestion>& suggestions);

// Tries them on top of the settings in their order, at most kMostTrials plans in all, and returns those that
// passed with what came of them. A number that did not do is tried again as the new plan asks for, at most
// twice. Of one that did the smallest change that passes is looked for, down to a step of its setting
// (remedies.hpp): a hundredth to a thousandth of a tolerance, 0.01 mm of a blade's thickness, 1 mm of a
// block, 10 mm of a blade's length. That takes at most kMostSteps plans for a number and kMostNarrowing in
// all: where these run out, both sides are farther apart. No clock ends it, so that the same job gives the
// same answer: it takes kMostPlans plans at most.
inline constexpr int kMostTrials = 6, kMostSteps = 12, kMostNarrowing = 20;
inline constexpr int kMostPlans = kMostTrials + kMostNarrowing;
[[nodiscard]] std::vector<TriedRemedy> try_changes(const Settings& settings,
                                                   const std::vector<SettingsChange>& changes,
                                                   const PlanAgain& plan_again);

// Returns the change as it is given on the command line, in the options that win over all others: `--up y`,
// `--tolerance 1.3`, `--set "machine.plinth_mm=160"`, `without slice.direction`.
[[nodiscard]] std::string as_options(const TriedRemedy& remedy);

// Returns the smallest change that passed and the largest that did not: `1.24 mm passes, 1.23 mm does not`.
[[nodiscard]] std::string describe(const TriedRemedy::Narrowed& narrowed);

// Returns the options with which a tried remedy passed, and what came of it: `--tolerance 1.3: passes,
// deviation 1.21 mm, 2 strips, verdict green`.
[[nodiscard]] std::string describe(const TriedRemedy& remedy);

}  // namespace hotblade::pipeline
