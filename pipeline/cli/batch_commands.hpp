// hotblade batch and its commands, and stock list.
#pragma once

#include <string>

#include "pipeline/cli/command.hpp"

namespace CLI {
class App;
}

namespace hotblade::pipeline {

// Registers `batch`, as command.hpp says of the others.
void add_batch(CLI::App& app, const Console& console, Action& action);

// Registers `stock`.
void add_stock(CLI::App& app, const Console& console, Action& action);

// Registers what works on a batch that is there: run, status and gather.
void add_batch_work(CLI::App& batch, const Console& console, Action& action);

// Adds the positional DIR.
void add_batch_directory(CLI::App& command, std::string& directory);

}  // namespace hotblade::pipeline
