// How settings and programs say how a file is read, and which part of it is the design.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "pipeline/program/program.hpp"
#include "pipeline/settings/settings.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// Returns how settings say that a file is read.
[[nodiscard]] surface::ReadOptions read_options(const DesignSettings& settings);

// Sets what the file's own format says: glTF is in metres with y up. Throws Error (kBadSettings) where the
// settings say otherwise; `up_given`: `up` was asked for and is no default. A file that cannot be opened, or
// contradicts itself, is told of by its reader.
void take_format(const std::filesystem::path& file, bool up_given, DesignSettings& settings);

// Throws Error (kBadSettings) where the settings say how far faces may look aside, and not from what. It is
// asked of what is to be planned: programs may keep such settings, and resolve() sees parts of them.
void expect_facing(const DesignSettings& settings);

// Returns how the program's plan read its design.
[[nodiscard]] DesignSettings read_by(const Program& program);

// A setting of how a design is read, that two sides have otherwise.
struct ReadOtherwise {
  std::string key;  // "units", of the section design
  std::string one, other;
};
// Returns the first of `keys` ("design.units") about reading that the two have otherwise; a unit or a format
// that one of them leaves open is none.
[[nodiscard]] std::optional<ReadOtherwise> read_otherwise(const DesignSettings& one,
                                                          const DesignSettings& other,
                                                          const std::set<std::string>& keys);

// Return the design of a file, as settings say or as the program's plan read it. Throw as
// surface::read_surface() does.
[[nodiscard]] surface::DesignSurface read_design(const std::filesystem::path& file,
                                                 const DesignSettings& settings);
[[nodiscard]] surface::DesignSurface read_design(const std::filesystem::path& file, const Program& program);

}  // namespace hotblade::pipeline
