// What a report says of the arms that hold a plan's clamps.
#pragma once

#include <string>

#include "pipeline/plan/plan.hpp"
#include "pipeline/report/words.hpp"

namespace hotblade::pipeline {

// Returns the table of the arms of all strips as HTML; empty without a cell.
[[nodiscard]] std::string arms_section(const PlanResult& result, const Words& w);

}  // namespace hotblade::pipeline
