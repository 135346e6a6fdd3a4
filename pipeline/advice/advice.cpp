#include "pipeline/advice/advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "pipeline/sayings/saying.hpp"
#include "pipeline/settings/assignments.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/verify/verdict.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

namespace {

bool refused_for(const PlanResult& result, Limit limit) {
  return std::any_of(result.refusals.begin(), result.refusals.end(),
                     [&](const Refusal& r) { return r.limit == limit; });
}

SettingsChange change_of(const Suggestion& suggestion) {
  return {suggestion.assignments,
          "",
          suggestion.why,
          [assignments = suggestion.assignments](Settings& s) {
            s = with_assignments(std::move(s), assignments);
          },
          {}};
}

// A change of the refused plan's own settings.
SettingsChange change_of(const Settings& settings, const Remedy& remedy) {
  return {{assignment_of(settings, remedy)},
          "",
          remedy.why,
          [remedy](Settings& s) { s = with_remedy(std::move(s), remedy); },
          remedy};
}

// Planes that were given, left to the search.
std::vector<SettingsChange> changes_of_planes(const SliceSettings& slice) {
  std::vector<SettingsChange> changes;
  const std::string why = say(Saying::kPlanesGiven);
  const auto search = [](Settings& s) {
    s.slice.direction.reset();
    s.slice.fan_axis.reset();
  };
  if (slice.direction) changes.push_back({{}, "slice.direction", why, search, {}});
  if (slice.fan_axis) changes.push_back({{}, "slice.fan_axis", why, search, {}});
  return changes;
}

// The number of one setting, as the plan that was refused with another asks for; absent where it does not.
std::optional<SettingsChange> next_number(const SettingsChange& change, const Settings& settings,
                                          const PlanResult& again) {
  if (!change.remedy) return std::nullopt;
  for (const Remedy& remedy : remedies(again)) {
    if (remedy.setting == change.remedy->setting) return change_of(settings, remedy);
  }
  return std::nullopt;
}

TriedRemedy tried(const SettingsChange& change, const PlanResult& result) {
  return {change.assignments,
          change.without,
          change.why,
          result.program.verification.deviation_mm.max,
          result.program.verification.tolerance_mm,
          result.strips.size(),
          name(verdict_of(result.program).color),
          {}};
}

// Plans of a job with other settings, so many in all.
class Trials {
 public:
  Trials(const Settings& settings, const PlanAgain& plan_again)
      : settings_(settings), plan_again_(plan_again) {}

  // Returns the change with which the job passes, or the next number that the plan asks for, of a number the
  // smallest such change; absent where none passes.
  std::optional<TriedRemedy> pass(SettingsChange change) {
    constexpr int kMostNumbers = 3;
    double fails = change.remedy ? change.remedy->fails : 0;
    for (int step = 0; step < kMostNumbers && tried_ < kMostTrials; ++step) {
      ++tried_;
      const std::optional<PlanResult> again = with(change);
      if (!again) return std::nullopt;
      if (again->refusals.empty())
        return change.remedy ? narrowed(*change.remedy, fails, tried(change, *again)) : tried(change, *again);
      std::optional<SettingsChange> next = next_number(change, settings_, *again);
      if (!next) return std::nullopt;
      fails = change.remedy->value;
      change = std::move(*next);
    }
    return std::nullopt;
  }

 private:
  // Absent where the settings do not go together, or leave nothing of the design.
  std::optional<PlanResult> with(const SettingsChange& change) {
    Settings changed = settings_;
    try {
      change.apply(changed);
      return plan_again_(changed);
    } catch (const Error& error) {
      if (error.kind == ErrorKind::kInterrupted) throw;
      return std::nullopt;
    } catch (const surface::MeshError&) {
      return std::nullopt;  // no face looks that way
    }
  }

  // Goes from a number that passed towards one that did not: by one step first, as a number that was computed
  // is often the smallest that passes, and then to the middle between both until they are a step apart.
  TriedRemedy narrowed(const Remedy& remedy, double fails, TriedRemedy best) {
    const std::size_t all = steps_between(remedy, fails);
    std::size_t passes_at = 0, fails_at = all;
    const auto value_at = [&](std::size_t step) {
      return step == all ? fails : at_step(remedy, fails, step).value;
    };
    for (int tries = 0; tries < kMostSteps && fails_at - passes_at > 1 && narrowing_ < kMostNarrowing;
         ++tries) {
      const std::size_t next = tries == 0 ? 1 : passes_at + (fails_at - passes_at) / 2;
      const SettingsChange change = change_of(settings_, at_step(remedy, fails, next));
      ++narrowing_;
      const std::optional<PlanResult> again = with(change);
      if (again && again->refusals.empty()) {
        best = tried(change, *again);
        passes_at = next;
      } else {
        fails_at = next;
      }
    }
    best.narrowed = TriedRemedy::Narrowed{value_at(passes_at), value_at(fails_at), remedy.unit};
    return best;
  }

  const Settings& settings_;
  const PlanAgain& plan_again_;
  int tried_ = 0, narrowing_ = 0;
};

std::string as_option(const std::string& assignment) {
  for (const auto& [key, flag] : {std::pair{"design.units=", "--units "}, std::pair{"design.up=", "--up "},
                                  std::pair{"design.tolerance_mm=", "--tolerance "}}) {
    const std::string_view start(key);
    if (assignment.starts_with(start)) return flag + assignment.substr(start.size());
  }
  return "--set \"" + assignment + "\"";
}

}  // namespace

std::vector<SettingsChange> changes_by_shape(const std::vector<Suggestion>& suggestions) {
  std::vector<SettingsChange> changes;
  for (const Suggestion& suggestion : suggestions) changes.push_back(change_of(suggestion));
  return changes;
}

std::vector<SettingsChange> likely_changes(const PlanResult& refused,
                                           const std::vector<Suggestion>& suggestions) {
  std::vector<SettingsChange> changes = changes_by_shape(suggestions);
  const Settings& settings = refused.program.settings;
  for (SettingsChange& change : changes_of_planes(settings.slice)) changes.push_back(std::move(change));
  const Keep keep = settings.design.keep;
  const bool along_z = keep == Keep::kBelow || keep == Keep::kAbove;
  if (refused_for(refused, Limit::kLean) && along_z) {
    for (const Keep other : {Keep::kBack, Keep::kFront}) {
      SettingsChange change =
          change_of({{fmt::format("design.keep={}", name(other))}, say(Saying::kLeansNowhere)});
      const bool known = std::any_of(changes.begin(), changes.end(), [&](const SettingsChange& c) {
        return c.assignments == change.assignments;
      });
      if (!known) changes.push_back(std::move(change));
    }
  }
  for (const Remedy& remedy : remedies(refused)) changes.push_back(change_of(settings, remedy));
  return changes;
}

std::vector<TriedRemedy> try_changes(const Settings& settings, const std::vector<SettingsChange>& changes,
                                     const PlanAgain& plan_again) {
  Trials trials(settings, plan_again);
  std::vector<TriedRemedy> passed;
  for (const SettingsChange& change : changes) {
    if (auto found = trials.pass(change)) passed.push_back(std::move(*found));
  }
  return passed;
}

std::string as_options(const TriedRemedy& remedy) {
  if (!remedy.without.empty()) return say(Saying::kWithout, {remedy.without});
  std::string text;
  for (const std::string& assignment : remedy.assignments)
    text += (text.empty() ? "" : " ") + as_option(assignment);
  return text;
}

std::string describe(const TriedRemedy::Narrowed& narrowed) {
  const std::string unit = narrowed.unit.empty() ? "" : " " + narrowed.unit;
  return say(Saying::kSmallestTried,
             {fmt::format("{:.6g}{}", narrowed.passes, unit), fmt::format("{:.6g}{}", narrowed.fails, unit)});
}

std::string describe(const TriedRemedy& remedy) {
  return fmt::format("{}: passes, deviation {:.3f} mm (tolerance {:g} mm), {} strip{}, verdict {}",
                     as_options(remedy), remedy.deviation_mm, remedy.tolerance_mm, remedy.strips,
                     remedy.strips == 1 ? "" : "s", remedy.verdict) +
         (remedy.narrowed ? "; " + describe(*remedy.narrowed) : "");
}

}  // namespace hotblade::pipeline
