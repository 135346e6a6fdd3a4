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

// Returns the design read as the program's plan read it. Throws Error: kFile when it cannot be read,
// kBadInput when it is no design or another one than the program's.
[[nodiscard]] surface::DesignSurface read_design_of(const Program& program,
                                                    const std::filesystem::path& file);

}  // namespace hotblade::pipeline
