#include "pipeline/program/read_design.hpp"

#include <fmt/format.h>

#include <numbers>
#include <optional>

#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

namespace {

bool is_gltf(const std::filesystem::path& file, const DesignSettings& settings) {
  std::optional<surface::FileFormat> format = surface::format_named(settings.format);
  try {
    if (!format) format = surface::format_of_file(file);
  } catch (const surface::MeshError&) {
    return false;
  }
  return format == surface::FileFormat::kGltf;
}

}  // namespace

void take_format(const std::filesystem::path& file, bool up_given, DesignSettings& settings) {
  if (!is_gltf(file, settings)) return;
  if (!settings.units.empty() && settings.units != "m")
    throw Error(ErrorKind::kBadSettings, file.string() + ": glTF is in metres (design.units is " +
                                             settings.units + "): leave the units out");
  if (up_given && settings.up == "z")
    throw Error(ErrorKind::kBadSettings, file.string() + ": glTF has y up (z was asked for): leave `up` out");
  settings.format = "gltf";
  settings.units = "m";
  settings.up = "y";
}

void expect_facing(const DesignSettings& settings) {
  if (settings.facing || settings.facing_max_deg == DesignSettings{}.facing_max_deg) return;
  throw Error(ErrorKind::kBadSettings,
              fmt::format("design.facing_max_deg ({:g}, given without design.facing): "
                          "it says nothing alone",
                          settings.facing_max_deg));
}

surface::ReadOptions read_options(const DesignSettings& settings) {
  surface::ReadOptions options{settings.units, settings.up.front()};
  options.group = settings.group;
  if (settings.facing) options.facing = Eigen::Vector3d((*settings.facing).data());
  options.facing_max_rad = settings.facing_max_deg * std::numbers::pi / 180;
  options.stitch_mm = settings.stitch_mm;
  options.format = surface::format_named(settings.format);
  options.resolution_mm = settings.tolerance_mm / 10;
  return options;
}

surface::DesignSurface read_design(const std::filesystem::path& file, const DesignSettings& settings) {
  return surface::read_surface(file, read_options(settings));
}

surface::DesignSurface read_design(const std::filesystem::path& file, const Program& program) {
  DesignSettings settings = program.settings.design;
  settings.units = program.design.source_units;
  settings.up = std::string(1, program.design.up);
  if (program.design.format) settings.format = surface::name(*program.design.format);
  return read_design(file, settings);
}

}  // namespace hotblade::pipeline
