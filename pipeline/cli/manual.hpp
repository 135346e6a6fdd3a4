// The manual page and the shell completion, made from the command line's own description: they cannot say
// something else than --help does.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hotblade::pipeline {

// The manual page hotblade(1) as roff text, for man.
[[nodiscard]] std::string manual_page(const CLI::App& app);

// A bash script that completes commands, options, the values of options with a fixed choice, and file names.
[[nodiscard]] std::string bash_completion(const CLI::App& app);

// Returns the completion scripts for zsh, through its emulation of bash's, and for fish.
[[nodiscard]] std::string zsh_completion(const CLI::App& app);
[[nodiscard]] std::string fish_completion(const CLI::App& app);

}  // namespace hotblade::pipeline
