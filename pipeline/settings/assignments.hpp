// Settings changed as `--set` changes them.
#pragma once

#include <string>
#include <vector>

#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// Returns the settings with assignments ("design.keep=back") on top. Throws as resolve() does.
[[nodiscard]] Settings with_assignments(Settings settings, const std::vector<std::string>& assignments);

}  // namespace hotblade::pipeline
