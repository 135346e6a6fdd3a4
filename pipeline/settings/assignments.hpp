// Settings changed as `--set` changes them.
#pragma once

#include <string>
#include <vector>

#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {

// The value that takes back what was said of a key which may be absent ("slice.direction=absent").
inline constexpr const char* kAbsent = "absent";

// Returns the settings with assignments ("design.keep=back") on top. Throws as resolve() does.
[[nodiscard]] Settings with_assignments(Settings settings, const std::vector<std::string>& assignments);
// The same of flags; errors name them.
[[nodiscard]] Settings with_flags(Settings settings, const std::vector<SettingsFlag>& flags);
[[nodiscard]] SaidSettings with_flags(SaidSettings settings, const std::vector<SettingsFlag>& flags);

}  // namespace hotblade::pipeline
