#include "pipeline/program/read_design.hpp"

#include <numbers>

namespace hotblade::pipeline {

surface::DesignSurface read_design(const std::filesystem::path& file, const DesignSettings& settings) {
  surface::ReadOptions options{settings.units, settings.up.front()};
  options.group = settings.group;
  if (settings.facing) options.facing = Eigen::Vector3d((*settings.facing).data());
  options.facing_max_rad = settings.facing_max_deg * std::numbers::pi / 180;
  options.stitch_mm = settings.stitch_mm;
  options.format = surface::format_named(settings.format);
  options.resolution_mm = settings.tolerance_mm / 10;
  return surface::read_surface(file, options);
}

surface::DesignSurface read_design(const std::filesystem::path& file, const Program& program) {
  DesignSettings settings = program.settings.design;
  settings.units = program.design.source_units;
  settings.up = std::string(1, program.design.up);
  return read_design(file, settings);
}

}  // namespace hotblade::pipeline
