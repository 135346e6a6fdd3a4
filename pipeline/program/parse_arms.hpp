// What a program says of its arms, read from its JSON.
#pragma once

#include <string>

#include "pipeline/program/json_node.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Each throws Error (kBadInput) naming the place.
[[nodiscard]] ProgramCell cell_of(const JsonNode& node);
[[nodiscard]] StripArms strip_arms_of(const JsonNode& node);
[[nodiscard]] ClampJoints joints_of(const JsonNode& node);

// A program has joints in every pose, within their limits, and arms in every strip; or no cell and none of
// them. Throws Error (kBadInput) otherwise.
void expect_joints(const Program& program, const std::string& file_name);

}  // namespace hotblade::pipeline
