#include "pipeline/plan/nearest_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace hotblade::pipeline {

namespace {

// A strip's refusals may name a phase of it, too.
bool speaks_of(const Refusal& refusal, const StripFacts& strip) {
  return refusal.strip == strip.id || refusal.strip.starts_with(strip.id + " ");
}

// Those that add the most to a budget, where that is what is refused.
std::vector<bool> over_budget(const PlanResult& result) {
  // A half takes half of its whole's clamps' errors and more: those that add about as much are split as well.
  constexpr double kAbout = 0.9;
  const bool binds = std::any_of(result.refusals.begin(), result.refusals.end(),
                                 [](const Refusal& r) { return r.limit == Limit::kBudget; });
  std::vector<bool> over(result.strips.size(), false);
  const auto adds_mm = [](const StripFacts& strip) {
    return strip.deviation_bound_mm + strip.motion.clamp_error_mm;
  };
  double most_mm = 0;
  for (const StripFacts& strip : result.strips) most_mm = std::max(most_mm, adds_mm(strip));
  for (std::size_t i = 0; binds && i < over.size(); ++i)
    over[i] = adds_mm(result.strips[i]) >= kAbout * most_mm;
  return over;
}

// An amount over its limit, or under a least one, by this share of it; of a limit of 0 the amount itself.
double share_over(const Refusal& refusal) {
  const double over = std::abs(refusal.value - refusal.bound), of = std::abs(refusal.bound);
  if (!std::isfinite(over)) return std::numeric_limits<double>::infinity();
  return of > 0 ? over / of : over;
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
  std::vector<bool> failed = over_budget(result);
  for (std::size_t i = 0; i < failed.size(); ++i) {
    const StripFacts& strip = result.strips[i];
    const bool refused = std::any_of(result.refusals.begin(), result.refusals.end(),
                                     [&](const Refusal& r) { return speaks_of(r, strip); });
    failed[i] =
        failed[i] || refused || strip.deviation_bound_mm > result.program.settings.design.tolerance_mm;
  }
  if (std::none_of(failed.begin(), failed.end(), [](bool f) { return f; })) failed.clear();
  return failed;
}

Nearness nearness(const SweptPlan& swept, const PlanResult* verified) {
  const std::vector<bool> failed = verified ? failed_strips(*verified) : std::vector<bool>{};
  std::set<Limit> limits;
  bool off_design = false;
  double over = 0;
  for (const Refusal& r : verified ? verified->refusals : swept.refusals) {
    limits.insert(r.limit);
    off_design = off_design || r.limit == Limit::kDeviation || r.limit == Limit::kDeviationWithSag;
    over = std::max(over, share_over(r));
  }
  return {verified == nullptr,
          limits.size(),
          off_design,
          over,
          swept.refusals.size() + static_cast<std::size_t>(std::count(failed.begin(), failed.end(), true)),
          swept.strips.size()};
}

}  // namespace hotblade::pipeline
