// How settings and programs say how a file is read, and which part of it is the design.
#pragma once

#include <filesystem>

#include "pipeline/program/program.hpp"
#include "pipeline/settings/settings.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// Return the design of a file, as settings say or as the program's plan read it. Throw as
// surface::read_surface() does.
[[nodiscard]] surface::DesignSurface read_design(const std::filesystem::path& file,
                                                 const DesignSettings& settings);
[[nodiscard]] surface::DesignSurface read_design(const std::filesystem::path& file, const Program& program);

}  // namespace hotblade::pipeline
