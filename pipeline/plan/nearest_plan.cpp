#include "pipeline/plan/nearest_plan.hpp"

#include <algorithm>
#include <set>

namespace hotblade::pipeline {

namespace {

// A strip's refusals may name a phase of it, too.
bool speaks_of(const Refusal& refusal, const StripFacts& strip) {
  return refusal.strip == strip.id || refusal.strip.starts_with(strip.id + " ");
}

}  // namespace

std::vector<double> deviations_with_sag_mm(const PlanResult& result) {
  std::vector<double> deviations;
  for (const StripFacts& strip : result.strips) deviations.push_back(strip.deviation_with_sag_mm());
  return deviations;
}

std::vector<bool> misshapen_strips(const PlanResult& result) {
  std::vector<bool> misshapen;
  for (const StripFacts& strip : result.strips) {
    misshapen.push_back(std::any_of(result.refusals.begin(), result.refusals.end(), [&](const Refusal& r) {
      return speaks_of(r, strip) && is_of_the_shape(r.limit);
    }));
  }
  return misshapen;
}

std::vector<bool> too_far_strips(const PlanResult& result) {
  std::vector<bool> far;
  for (const StripFacts& strip : result.strips) {
    const bool with_sag = std::any_of(result.refusals.begin(), result.refusals.end(), [&](const Refusal& r) {
      return r.limit == Limit::kDeviationWithSag && r.strip == strip.id;
    });
    far.push_back(with_sag || strip.deviation_bound_mm > result.program.settings.design.tolerance_mm);
  }
  return far;
}

std::vector<bool> failed_strips(const PlanResult& result) {
  std::vector<bool> failed;
  for (const StripFacts& strip : result.strips) {
    const bool refused = std::any_of(result.refusals.begin(), result.refusals.end(),
                                     [&](const Refusal& r) { return speaks_of(r, strip); });
    failed.push_back(refused || strip.deviation_bound_mm > result.program.settings.design.tolerance_mm);
  }
  if (std::none_of(failed.begin(), failed.end(), [](bool f) { return f; })) failed.clear();
  return failed;
}

Nearness nearness(const SweptPlan& swept, const PlanResult* verified) {
  const std::vector<bool> failed = verified ? failed_strips(*verified) : std::vector<bool>{};
  std::set<Limit> limits;
  for (const Refusal& r : verified ? verified->refusals : swept.refusals) limits.insert(r.limit);
  return {verified == nullptr, limits.size(),
          swept.refusals.size() + static_cast<std::size_t>(std::count(failed.begin(), failed.end(), true)),
          swept.strips.size()};
}

}  // namespace hotblade::pipeline
