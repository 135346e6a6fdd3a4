#include "pipeline/program/read_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <string_view>

#include "pipeline/settings/assignments.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/settings_fields.hpp"

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

DesignSettings read_by(const Program& program) {
  DesignSettings settings = program.settings.design;
  settings.units = program.design.source_units;
  settings.up = std::string(1, program.design.up);
  if (program.design.format) settings.format = surface::name(*program.design.format);
  return settings;
}

std::optional<ReadOtherwise> read_otherwise(const DesignSettings& one, const DesignSettings& other,
                                            const std::set<std::string>& keys) {
  Settings first, second, unsaid;
  first.design = one;
  second.design = other;
  for (const SettingField& field : setting_fields()) {
    constexpr std::array kHowRead{"units", "up", "format", "group", "facing", "facing_max_deg", "stitch_mm"};
    if (field.section != "design" || !keys.contains(full_key(field)) ||
        std::find(kHowRead.begin(), kHowRead.end(), field.key) == kHowRead.end())
      continue;
    const auto text = [&field](Settings& of) { return toml_text(field.place(of)).value_or(kAbsent); };
    const std::string a = text(first), b = text(second), left_open = text(unsaid);
    const bool may_be_open = field.key == "units" || field.key == "format";
    if (a != b && !(may_be_open && (a == left_open || b == left_open)))
      return ReadOtherwise{std::string(field.key), a, b};
  }
  return std::nullopt;
}

surface::DesignSurface read_design(const std::filesystem::path& file, const Program& program) {
  return read_design(file, read_by(program));
}

}  // namespace hotblade::pipeline
