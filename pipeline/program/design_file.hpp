// The OBJ that a program was planned for, found again and proved to be the one.
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/program/program.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// Returns the path of the program's design: beside the program under its own name, or where run.json beside
// the program says that it was when it was planned; nothing when neither is there.
[[nodiscard]] std::optional<std::filesystem::path> design_at_hand(const std::filesystem::path& program_file,
                                                                  const Program& program);

// Returns the design that was given, else the one at hand. Throws Error (kFile) when neither is there, with
// where it was looked for.
[[nodiscard]] std::filesystem::path given_or_at_hand(const std::filesystem::path& given,
                                                     const std::filesystem::path& program_file,
                                                     const Program& program);

// Returns where the design is, or was when the program was planned: beside the program, or as run.json says;
// nothing when neither is known.
[[nodiscard]] std::optional<std::filesystem::path> design_path(const std::filesystem::path& program_file,
                                                               const Program& program);

// Returns what run.json beside the program says was given as its cell, a file or a name; nothing when it says
// none.
[[nodiscard]] std::optional<std::filesystem::path> cell_given(const std::filesystem::path& program_file);

// Returns the design read as the program's plan read it. Throws Error: kFile when it cannot be read,
// kBadInput when it is no design or another one than the program's.
[[nodiscard]] surface::DesignSurface read_design_of(const Program& program,
                                                    const std::filesystem::path& file);

}  // namespace hotblade::pipeline
