// Which of several refused plans comes nearest to one that passes: that one is shown.
#pragma once

#include <compare>
#include <cstddef>
#include <vector>

#include "pipeline/plan/plan.hpp"
#include "pipeline/plan/sweep/sweep_search.hpp"

namespace hotblade::pipeline {

// How far a refused plan is from one that passes; the smaller, the nearer. What was verified says more than a
// plan with a part that has no strip; then the fewer kinds of limits are broken the better, as each takes a
// change of its own; then one that keeps the tolerance is nearer than one that does not, as its blades fit
// the design; then the smaller the largest amount over a limit, as a share of it; then the fewer strips fail,
// then the fewer there are.
struct Nearness {
  bool unverified = true;
  std::size_t limits = 0;
  bool off_design = false;
  double over = 0;
  std::size_t failing = 0, strips = 0;
  friend std::partial_ordering operator<=>(const Nearness&, const Nearness&) = default;
};

// Returns it of a swept plan, with what its verification found where it came to that.
[[nodiscard]] Nearness nearness(const SweptPlan& swept, const PlanResult* verified);

// Returns which strips of a verified plan refusals speak of, or deviate by more than allowed; empty where
// none does.
[[nodiscard]] std::vector<bool> failed_strips(const PlanResult& result);

// Returns how far each strip leaves the design, with what of its sag is not known.
[[nodiscard]] std::vector<double> deviations_with_sag_mm(const PlanResult& result);

// Returns which strips a limit of their blade's shape refuses (robot/pose/limit.hpp).
[[nodiscard]] std::vector<bool> misshapen_strips(const PlanResult& result);

// Returns which strips leave the design too far, with their sag or without.
[[nodiscard]] std::vector<bool> too_far_strips(const PlanResult& result);

}  // namespace hotblade::pipeline
