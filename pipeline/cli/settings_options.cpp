#include "pipeline/cli/settings_options.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>

#include "pipeline/program/read_design.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {
namespace {

// One value per flag: without this, the parser would take the words that follow for more values.
CLI::Option* one_each(CLI::Option* option) {
  return option->allow_extra_args(false);
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
  expect_facing(settings.design);
  take_format(options.file, !options.up.empty(), settings.design);
  if (settings.design.units.empty()) {
    if (std::error_code unknown; !std::filesystem::exists(options.file, unknown))
      throw Error(ErrorKind::kFile, options.file + ": no such file: check the path");
    throw Error(ErrorKind::kBadSettings,
                options.file +
                    ": no unit given: the file carries none: say --units mm, cm, m, in or ft, or "
                    "set design.units in a --config file");
  }
  return settings;
}

}  // namespace hotblade::pipeline
