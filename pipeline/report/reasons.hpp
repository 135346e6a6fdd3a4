// Why a plan that passed is as it is: its direction, its split and each strip's blade, from what was tried
// and what the next choices come to.
#pragma once

#include <optional>
#include <string>

#include "pipeline/plan/plan.hpp"
#include "pipeline/report/words.hpp"

namespace hotblade::pipeline {

// Of a design with creases these two are told of each face in the section's table.

// Returns why these planes and not others: given, or ranked, with what the next best would take.
[[nodiscard]] std::string direction_reason(const PlanResult& result, const Words& w);

// Returns why so many strips: what fewer failed by, or that fewer cannot be, and what one more would take.
[[nodiscard]] std::string split_reason(const PlanResult& result, const Words& w);

// Returns of a design with creases that each of its faces was planned alone, and what one more strip would
// take; empty where it has none.
[[nodiscard]] std::string creases_reason(const PlanResult& result, const Words& w);

// Returns what planes that were ranked by rows of blocks come to: strips, or the blocks that they fill at
// least.
[[nodiscard]] std::string rows_text(const PlanesTried& tried, const Words& w);

// Returns a blade of another length in words: what stops it, or what weight moves the cut with it.
[[nodiscard]] std::string blade_text(const BladeTrial& trial, const Words& w);

// Returns the page's section as HTML, a row a strip; empty of a plan that did not pass.
[[nodiscard]] std::string reasons_section(const PlanResult& result, const Words& w);

}  // namespace hotblade::pipeline
