// hotblade config: shows, documents and checks settings.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "pipeline/cli/command.hpp"
#include "pipeline/cli/settings_options.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline {
namespace {

Exit show(const SettingsSources& sources) {
  std::cout << to_toml(resolve(sources));
  return Exit::kOk;
}

Exit show_defaults() {
  std::cout << to_toml(Settings{});
  return Exit::kOk;
}

// Every file on its own, on top of the defaults. All files are looked at; a file that cannot be read
// outweighs a wrong one.
Exit validate_files(const std::vector<std::string>& files, const Console& console) {
  Exit result = Exit::kOk;
  for (const std::string& file : files) {
    try {
      (void)resolve({{file}, {}, {}});
      std::cout << file << ": ok\n";
    } catch (const Error& error) {
      console.warn(error.what());
      result = std::max(result, exit_of(error.kind));
    }
  }
  return result;
}

}  // namespace

void add_config(CLI::App& app, const Console& console, Action& action) {
  auto* config = app.add_subcommand("config", "Show, document and check settings");
  config->require_subcommand(1);
  config->footer("Example: hotblade config show --config job.toml --set blade.kerf_mm=1.2");

  auto sources = std::make_shared<SettingsSources>();
  auto* show_command = config->add_subcommand("show", "Print the settings that result, as TOML");
  add_settings_options(*show_command, *sources);
  show_command->footer("Example: hotblade config show --config job.toml --set design.keep=back");
  show_command->callback([sources, &action] { action = [sources] { return show(*sources); }; });

  auto* defaults_command =
      config->add_subcommand("defaults", "Print every setting at its default, with comments");
  defaults_command->footer("Example: hotblade config defaults > machine.toml");
  defaults_command->callback([&action] { action = show_defaults; });

  auto files = std::make_shared<std::vector<std::string>>();
  auto* validate_command =
      config->add_subcommand("validate", "Check settings files: exit 0 when all are good, else 2");
  validate_command->add_option("files", *files, "TOML files")->required()->type_name("FILE");
  validate_command->footer("Example: hotblade config validate job.toml machine.toml");
  validate_command->callback(
      [files, &console, &action] { action = [files, &console] { return validate_files(*files, console); }; });
}

}  // namespace hotblade::pipeline
