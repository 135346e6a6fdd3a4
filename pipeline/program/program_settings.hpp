// The settings a program carries: the resolved configuration its plan was made with.
#pragma once

#include "pipeline/program/json_node.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// Returns the settings that a program's `settings` say. A key that is left out has its default: programs of
// before the key was known were planned as that default says. Throws Error (kBadInput) for a section or key
// that this version does not know, as a limit it would not keep to may stand there, for a wrong type, for a
// value out of range, and where keys do not go together.
[[nodiscard]] Settings settings_of(const JsonNode& node);

}  // namespace hotblade::pipeline
