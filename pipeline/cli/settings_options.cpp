#include "pipeline/cli/settings_options.hpp"

#include <CLI/CLI.hpp>

#include <optional>

#include "pipeline/settings/error.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {
namespace {

// One value per flag: without this, the parser would take the words that follow for more values.
CLI::Option* one_each(CLI::Option* option) {
  return option->allow_extra_args(false);
}

// A file that cannot be opened, or contradicts itself, is told of by its reader.
bool is_gltf(const std::string& file, const Settings& settings) {
  std::optional<surface::FileFormat> format = surface::format_named(settings.design.format);
  try {
    if (!format) format = surface::format_of_file(file);
  } catch (const surface::MeshError&) {
    return false;
  }
  return format == surface::FileFormat::kGltf;
}

void take_gltf(const DesignOptions& options, Settings& settings) {
  const std::string& units = settings.design.units;
  if (!units.empty() && units != "m")
    throw Error(ErrorKind::kBadSettings,
                options.file + ": glTF is in metres (design.units is " + units + "): leave --units out");
  if (options.up == "z")
    throw Error(ErrorKind::kBadSettings, options.file + ": glTF has y up (--up z): leave --up out");
  settings.design.format = "gltf";
  settings.design.units = "m";
  settings.design.up = "y";
}

}  // namespace

void add_settings_options(CLI::App& command, SettingsSources& sources) {
  one_each(command.add_option("--config", sources.files, "Settings in TOML; later files win"))
      ->type_name("FILE");
  one_each(
      command.add_option("--set", sources.assignments, "One setting, as design.keep=back; wins over files"))
      ->type_name("KEY=VALUE");
}

void add_design_options(CLI::App& command, DesignOptions& options) {
  command.add_option("design", options.file, "The design surface: OBJ, STL, PLY, glTF or GLB")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--units", options.units,
                  "Unit of the file's numbers; required here or as design.units, but for glTF")
      ->type_name("mm|cm|m|in|ft");
  command.add_option("--up", options.up, "Axis of the file that points up")->type_name("z|y");
  command.add_option("--format", options.format, "Format of the file; auto: as its bytes and its name tell")
      ->type_name("auto|obj|stl|ply|gltf");
  add_settings_options(command, options.sources);
}

Settings resolve_design(const DesignOptions& options) {
  SettingsSources sources = options.sources;
  if (!options.units.empty()) sources.flags.push_back({"--units", "design.units", options.units});
  if (!options.up.empty()) sources.flags.push_back({"--up", "design.up", options.up});
  if (!options.format.empty()) sources.flags.push_back({"--format", "design.format", options.format});
  Settings settings = resolve(sources);
  if (is_gltf(options.file, settings)) {
    take_gltf(options, settings);
    return settings;
  }
  if (settings.design.units.empty()) {
    throw Error(ErrorKind::kBadSettings,
                options.file +
                    ": no unit given: the file carries none: say --units mm, cm, m, in or ft, or "
                    "set design.units in a --config file");
  }
  return settings;
}

}  // namespace hotblade::pipeline
