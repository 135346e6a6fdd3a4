// hotblade completion: the manual page and the shell completion as text.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "pipeline/cli/command.hpp"
#include "pipeline/cli/manual.hpp"

namespace hotblade::pipeline {

void add_completion(CLI::App& app, const Console&, Action& action) {
  auto what = std::make_shared<std::string>();
  auto* command =
      app.add_subcommand("completion", "Print the completion script of a shell or the manual page");
  command->add_option("shell", *what, "The shell, or man for the manual page in roff")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish", "man"}))
      ->type_name("bash|zsh|fish|man");
  command->footer("Example: hotblade completion bash > ~/.local/share/bash-completion/completions/hotblade");
  command->callback([what, &app, &action] {
    action = [what, &app] {
      if (*what == "man") std::cout << manual_page(app);
      if (*what == "bash") std::cout << bash_completion(app);
      if (*what == "zsh") std::cout << zsh_completion(app);
      if (*what == "fish") std::cout << fish_completion(app);
      return Exit::kOk;
    };
  });
}

}  // namespace hotblade::pipeline
