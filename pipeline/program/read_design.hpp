// How settings and programs say which part of an OBJ is the design.
#pragma once

#include <filesystem>

#include "pipeline/program/program.hpp"
#include "pipeline/settings/settings.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// Throw as surface::read_obj() does. A program's design is read as it was when it was planned.
[[nodiscard]] surface::DesignSurface read_design(const std::filesystem::path& file,
                                                 const DesignSettings& settings);
[[nodiscard]] surface::DesignSurface read_design(const std::filesystem::path& file, const Program& program);

}  // namespace hotblade::pipeline
