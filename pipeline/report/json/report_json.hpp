// report.json: what a plan says of itself to programs. This room draws nothing, so that a library which plans
// needs no pictures.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pipeline/plan/plan.hpp"

namespace hotblade::pipeline {

// Returns the text of report.json: verdict, strips, ribs, ranking, refusals, warnings, budget, what was not
// checked. `program_sha256` is that of the text of the program beside it, in hex; empty: there is none.
[[nodiscard]] std::string report_json(const PlanResult& result, const std::string& program_sha256 = "");

// Return parts of it: a refusal, the remedies that were tried and passed, and the arms of a strip.
[[nodiscard]] nlohmann::ordered_json to_json(const Refusal& refusal);
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<TriedRemedy>& remedies);
[[nodiscard]] nlohmann::ordered_json arms_json(const StripArms& arms);

}  // namespace hotblade::pipeline
