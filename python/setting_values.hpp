// Values of Python as the text of settings.
#pragma once

#include "pipeline/settings/settings.hpp"
#include "python/module.hpp"

namespace hotblade::python {

// Returns a value as TOML, or the word for an absent one (None or an empty list, of keys that may be absent).
// Throws Error (kBadSettings) with the key where settings have no such values.
[[nodiscard]] std::string toml_value(const py::handle& value, const std::string& key);

// Returns what a mapping says of settings; errors will name `where`. None says nothing.
[[nodiscard]] std::vector<pipeline::SettingsFlag> flags_of(const py::object& values,
                                                           const std::string& where);

}  // namespace hotblade::python
