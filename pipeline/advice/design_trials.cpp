#include "pipeline/advice/design_trials.hpp"

#include <fmt/format.h>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/settings/error.hpp"
#include "surface/read/self_crossings.hpp"

namespace hotblade::pipeline {

void refuse_blocked(const surface::DesignSurface& design, const std::string& file) {
  if (design.health.blockers.empty()) return;
  throw Error(ErrorKind::kBadInput, file + ": cannot be sliced: " + design.health.blockers.front());
}

namespace {

bool can_be_forecast(const surface::DesignSurface& design) {
  return design.health.blockers.empty() && design.health.area_mm2 > 0;
}

// Of a forecast or a first look.
template <typename Look>
void warn_of(const Look& look, surface::DesignSurface& design) {
  if (const auto warning = warning_of(look.odd_size)) design.health.warnings.push_back(*warning);
  if (look.planes_warning) design.health.warnings.push_back(*look.planes_warning);
}

}  // namespace

std::optional<Forecast> forecast_of(surface::DesignSurface& design, const Settings& settings) {
  if (!can_be_forecast(design)) return std::nullopt;
  Forecast met = forecast(design, settings);
  warn_of(met, design);
  return met;
}

FirstLook first_look_of(surface::DesignSurface& design, const Settings& settings) {
  if (!can_be_forecast(design)) return {};
  FirstLook look = first_look(design, settings);
  warn_of(look, design);
  return look;
}

std::optional<std::string> warning_of(const std::optional<OddSize>& odd) {
  if (!odd || !odd->hopeless) return std::nullopt;
  return describe(*odd);
}

void refuse_warnings(PlanResult& result) {
  result.refusals.push_back({"design", "", Limit::kWarnings, static_cast<double>(result.warnings.size()), 0,
                             say(Saying::kFirstWarning, {result.warnings.front()})});
  result.program.verification.status = VerificationStatus::kRefused;
}

void hold_in_cell(const surface::DesignSurface& design, const robot::Cell& cell, gpu::Backend backend,
                  PlanResult& result) {
  if (!result.refusals.empty()) return;
  ArmedProgram armed = with_arms(result.program, cell);
  result.program = std::move(armed.program);
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    const Strip& strip = result.program.strips[i];
    if (!strip.arms) continue;
    result.strips[i].plinth_mm += strip.arms->raise_mm;
    time_facts(strip.poses, result.strips[i].motion);
  }
  result.warnings.insert(result.warnings.end(), armed.report.warnings.begin(), armed.report.warnings.end());
  result.refusals = std::move(armed.report.refusals);
  if (!result.refusals.empty()) {
    result.program.verification.status = VerificationStatus::kRefused;
  } else if (result.program.blade.melt.by_speed()) {
    measure_again(design, backend, result);
  }
}

PlanResult plan_again(const ReadAgain& read, const Settings& settings, const PlanHooks& hooks, bool strict,
                      const JudgeAgain& judge) {
  surface::DesignSurface design = read(settings.design);
  refuse_blocked(design, design.file_name);
  PlanResult result = plan(design, settings, hooks);
  judge(design, result);
  if (!strict) return result;
  (void)first_look_of(design, settings);
  for (const std::string& line : design.health.warnings) result.warnings.push_back(line);
  if (const std::string text = surface::self_crossings_text(design, gpu::stop_point); !text.empty())
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
