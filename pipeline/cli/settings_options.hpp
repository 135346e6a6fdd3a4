// The options that name a design and its settings, shared by the commands that take them.
#pragma once

#include <string>

#include "pipeline/settings/settings.hpp"

namespace CLI {
class App;
}

namespace hotblade::pipeline {

// Adds --config FILE and --set KEY=VALUE, both as often as wanted.
void add_settings_options(CLI::App& command, SettingsSources& sources);

// A design as commands take it: its file, --units, --up, --format, --config and --set.
struct DesignOptions {
  std::string file;
  std::string units, up, format;  // empty: not given
  SettingsSources sources;
};
void add_design_options(CLI::App& command, DesignOptions& options);

// The settings those options amount to. Throws Error as resolve() does, and (kBadSettings) when no
// unit is given: neither by --units nor as design.units.
[[nodiscard]] Settings resolve_design(const DesignOptions& options);

}  // namespace hotblade::pipeline
