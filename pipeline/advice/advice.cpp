#include "pipeline/advice/advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "pipeline/advice/remedies.hpp"
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
  return {suggestion.assignments, "", suggestion.why, [assignments = suggestion.assignments](Settings& s) {
            s = with_assignments(std::move(s), assignments);
          }};
}

// A change of the refused plan's own settings.
SettingsChange change_of(const Settings& settings, const Remedy& remedy) {
  return {{assignment_of(settings, remedy)}, "", remedy.why, [remedy](Settings& s) {
            s = with_remedy(std::move(s), remedy);
          }};
}

// Planes that were given, left to the search.
std::vector<SettingsChange> changes_of_planes(const SliceSettings& slice) {
  std::vector<SettingsChange> changes;
  const std::string why = "the planes that were given: others may do";
  const auto search = [](Settings& s) {
    s.slice.direction.reset();
    s.slice.fan_axis.reset();
  };
  if (slice.direction) changes.push_back({{}, "slice.direction", why, search});
  if (slice.fan_axis) changes.push_back({{}, "slice.fan_axis", why, search});
  return changes;
}

// The number of one setting, as the plan that was refused with another asks for; absent where it does not.
std::optional<SettingsChange> next_number(const SettingsChange& change, const Settings& settings,
                                          const PlanResult& again) {
  if (change.assignments.size() != 1) return std::nullopt;
  const std::string& assignment = change.assignments.front();
  const std::string key = assignment.substr(0, assignment.find('='));
  for (const Remedy& remedy : remedies(again)) {
    if (remedy.setting == key) return change_of(settings, remedy);
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
          name(verdict_of(result.program).color)};
}

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
          change_of({{fmt::format("design.keep={}", name(other))}, "the surface leans past the vertical"});
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
  constexpr int kMostSteps = 3;
  std::vector<TriedRemedy> passed;
  int trials = 0;
  for (SettingsChange change : changes) {
    for (int step = 0; step < kMostSteps && trials < kMostTrials; ++step) {
      Settings changed = settings;
      ++trials;
      PlanResult again;
      try {
        change.apply(changed);
        again = plan_again(changed);
      } catch (const Error& error) {
        if (error.kind == ErrorKind::kInterrupted) throw;
        break;  // settings that do not go together, or a design that they leave nothing of
      } catch (const surface::MeshError&) {
        break;  // no face looks that way
      }
      if (again.refusals.empty()) {
        passed.push_back(tried(change, again));
        break;
      }
      const std::optional<SettingsChange> next = next_number(change, settings, again);
      if (!next) break;
      change = *next;
    }
  }
  return passed;
}

std::string as_options(const TriedRemedy& remedy) {
  if (!remedy.without.empty()) return "without " + remedy.without;
  std::string text;
  for (const std::string& assignment : remedy.assignments)
    text += (text.empty() ? "" : " ") + as_option(assignment);
  return text;
}

std::string describe(const TriedRemedy& remedy) {
  return fmt::format("{}: passes, deviation {:.3f} mm (tolerance {:g} mm), {} strip{}, verdict {}",
                     as_options(remedy), remedy.deviation_mm, remedy.tolerance_mm, remedy.strips,
                     remedy.strips == 1 ? "" : "s", remedy.verdict);
}

}  // namespace hotblade::pipeline
