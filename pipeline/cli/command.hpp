// One command of the command line: adds its options to the parser and runs.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "pipeline/cli/exit.hpp"
#include "pipeline/verify/verdict.hpp"

namespace CLI {
class App;
}

namespace hotblade::pipeline {

// What every command shares. Everything here goes to stderr (stdout carries results only), and every line but
// the progress to the log file too, when there is one. From any thread.
struct Console {
  bool quiet = false;
  int verbose = 0;
  std::string progress = "auto";  // auto, bar, json or none
  std::string log_file;           // appended to; empty: none

  // Shows progress: a bar on a terminal, NDJSON {"stage": "...", "progress": 0..1} with --progress json.
  // `fraction` is that of the whole command; a value below one already shown is raised to it, so what is
  // shown never goes back.
  void report_progress(const std::string& stage, double fraction) const;
  // Writes one line, only with -v.
  void detail(const std::string& line) const;
  // Writes one line, unless quiet.
  void note(const std::string& line) const;
  // Writes one line, always.
  void warn(const std::string& line) const;
  // Ends a half-drawn bar, so that what follows starts on a line of its own.
  void end_progress() const;

 private:
  void write(const std::string& line, bool show) const;
  void close_bar() const;
  mutable double shown_ = -1;
  mutable std::string shown_stage_;
  mutable bool bar_open_ = false;
  mutable std::mutex mutex_;
};

// More threads than this are a slip of the keyboard.
inline constexpr int kMostThreads = 1024;

enum class Paint { kGood, kBad, kWarning };
[[nodiscard]] Paint paint_of(VerdictColor color);

// The text in colour where the descriptor is a terminal and NO_COLOR is not set; else as it is.
[[nodiscard]] std::string painted(const std::string& text, Paint paint, int descriptor);

// Registers a subcommand; when it was called, `action` holds what to run.
using Action = std::function<Exit()>;
void add_check(CLI::App& app, const Console& console, Action& action);
void add_plan(CLI::App& app, const Console& console, Action& action);
void add_calibrate(CLI::App& app, const Console& console, Action& action);
void add_verify(CLI::App& app, const Console& console, Action& action);
void add_cell(CLI::App& app, const Console& console, Action& action);
void add_config(CLI::App& app, const Console& console, Action& action);
void add_curve(CLI::App& app, const Console& console, Action& action);
void add_study(CLI::App& app, const Console& console, Action& action);
void add_place(CLI::App& app, const Console& console, Action& action);
void add_preview(CLI::App& app, const Console& console, Action& action);
void add_sim(CLI::App& app, const Console& console, Action& action);
void add_run(CLI::App& app, const Console& console, Action& action);
void add_dryrun(CLI::App& app, const Console& console, Action& action);
void add_export(CLI::App& app, const Console& console, Action& action);
void add_completion(CLI::App& app, const Console& console, Action& action);
void add_ribs(CLI::App& app, const Console& console, Action& action);

// Whether SIGINT or SIGTERM has come: who moves a machine or writes asks, and ends with Exit::kInterrupted;
// other work is ended (ends_on_signal.hpp). A second signal ends the program at once.
[[nodiscard]] bool interrupted();

// Splits argv, runs one command, prints errors; returns the exit code.
int run_command_line(int argc, char** argv);

}  // namespace hotblade::pipeline
