#include "pipeline/cli/design_trials.hpp"

#include <fmt/format.h>

#include "pipeline/program/read_design.hpp"
#include "pipeline/settings/error.hpp"
#include "surface/read/self_crossings.hpp"

namespace hotblade::pipeline {

void refuse_blocked(const surface::DesignSurface& design, const std::string& file) {
  if (design.health.blockers.empty()) return;
  throw Error(ErrorKind::kBadInput, file + ": cannot be sliced: " + design.health.blockers.front());
}

std::optional<Forecast> forecast_of(surface::DesignSurface& design, const Settings& settings) {
  if (!design.health.blockers.empty() || !(design.health.area_mm2 > 0)) return std::nullopt;
  Forecast met = forecast(design, settings);
  if (met.odd_size && met.odd_size->hopeless) design.health.warnings.push_back(describe(*met.odd_size));
  return met;
}

void refuse_warnings(PlanResult& result) {
  result.refusals.push_back({"design", "", Limit::kWarnings, static_cast<double>(result.warnings.size()), 0,
                             "first: " + result.warnings.front()});
  result.program.verification.status = VerificationStatus::kRefused;
}

PlanResult plan_again(const std::string& file, const Settings& settings, const PlanHooks& hooks, bool strict,
                      const JudgeAgain& judge) {
  surface::DesignSurface design = read_design(file, settings.design);
  refuse_blocked(design, file);
  PlanResult result = plan(design, settings, hooks);
  judge(design, result);
  if (!strict) return result;
  (void)forecast_of(design, settings);
  for (const std::string& line : design.health.warnings) result.warnings.push_back(line);
  if (const std::string text = surface::self_crossings_text(design); !text.empty())
    result.warnings.push_back(text);
  if (!result.warnings.empty()) refuse_warnings(result);
  return result;
}

std::vector<std::string> tried_lines(const std::vector<TriedRemedy>& remedies) {
  if (remedies.empty()) return {"tried: nothing passed of what might have helped"};
  std::vector<std::string> lines;
  for (const TriedRemedy& remedy : remedies)
    lines.push_back(fmt::format("tried ({}): {}", remedy.why, describe(remedy)));
  return lines;
}

}  // namespace hotblade::pipeline
