// What `hotblade verify --json` says of a program.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pipeline/program/program.hpp"
#include "pipeline/verify/verify.hpp"

namespace hotblade::pipeline {

// Returns the text: deviation, uncut area, samples, strips, ribs that are not as the program says. `joints`
// is what was found of the arms' joints; null: they were not looked at.
[[nodiscard]] std::string verify_json(const Program& program, const VerifyReport& report,
                                      const VerifyOptions& options, const nlohmann::ordered_json& joints);

}  // namespace hotblade::pipeline
