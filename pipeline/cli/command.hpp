// One command of the command line: adds its options to the parser and runs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pipeline/command_error.hpp"

namespace CLI {
class App;
}

namespace hotblade::pipeline {

// What every command shares.
struct Console {
  bool quiet = false;
  int verbose = 0;
  std::string progress = "auto";  // auto, bar, json or none
  std::string log_file;

  // Progress to stderr: a bar on a terminal, NDJSON {"progress": 0..1, "stage": "..."} with --progress json; the
  // fraction never goes back. Safe to call from one thread at a time.
  void report_progress(const std::string& stage, double fraction) const;
  // One line to stderr unless quiet.
  void note(const std::string& line) const;
  // One line to stderr, always.
  void warn(const std::string& line) const;

 private:
  mutable double shown_ = -1;
  mutable std::string shown_stage_;
};

// Registers a subcommand; when it was called, `action` holds what to run.
using Action = std::function<Exit()>;
void add_check(CLI::App& app, const Console& console, Action& action);
void add_plan(CLI::App& app, const Console& console, Action& action);
void add_verify(CLI::App& app, const Console& console, Action& action);
void add_config(CLI::App& app, const Console& console, Action& action);
void add_preview(CLI::App& app, const Console& console, Action& action);

// Set by SIGINT and SIGTERM; long work looks at it and ends with Exit::kInterrupted.
[[nodiscard]] bool interrupted();

// Splits argv, runs one command, prints errors; returns the exit code.
int run_command_line(int argc, char** argv);

}  // namespace hotblade::pipeline
