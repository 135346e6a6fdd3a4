// hotblade completion: the manual page and the shell completion as text.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "pipeline/cli/command.hpp"
#include "pipeline/cli/manual.hpp"

namespace hotblade::pipeline {

void add_completion(CLI::App& app, const Console&, Action& action) {
  auto what = std::make_shared<std::string>();
  auto* command = app.add_subcommand("completion", "Print the bash completion script or the manual page");
  command->add_option("what", *what, "bash, or man for the manual page in roff")
      ->required()
      ->check(CLI::IsMember({"bash", "man"}))
      ->type_name("bash|man");
  command->footer("Example: hotblade completion bash > ~/.local/share/bash-completion/completions/hotblade");
  command->callback([what, &app, &action] {
    action = [what, &app] {
      std::cout << (*what == "bash" ? bash_completion(app) : manual_page(app));
      return Exit::kOk;
    };
  });
}

}  // namespace hotblade::pipeline
