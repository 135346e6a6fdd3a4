// hotblade batch run, status, gather: plans chunks, says how far a batch is, and puts its results together.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <thread>

#include "pipeline/batch/gather.hpp"
#include "pipeline/batch/result.hpp"
#include "pipeline/batch/run.hpp"
#include "pipeline/batch/status.hpp"
#include "pipeline/cli/batch_commands.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;

struct RunArguments {
  std::string directory, program;
  int chunk = -1, jobs = 0;
  bool all = false;
  batch::RunOptions options;
};

constexpr int kMostChunkNumber = 999'999;
constexpr double kLongestLimitS = 7 * 24 * 3600;
constexpr int kLeastLimitMb = 10, kMostLimitMb = 10'000'000;

std::vector<int> chunks_asked(const RunArguments& arguments, const batch::Batch& made) {
  if (arguments.all == (arguments.chunk >= 0))
    throw Error(ErrorKind::kBadSettings, "give --chunk K or --all, one of them");
  if (!arguments.all && arguments.chunk >= made.chunks) {
    throw Error(ErrorKind::kBadSettings,
                fmt::format("--chunk {}: the batch has chunks 0 to {}", arguments.chunk, made.chunks - 1));
  }
  std::vector<int> chunks(arguments.all ? static_cast<std::size_t>(made.chunks) : 1, arguments.chunk);
  if (arguments.all) std::iota(chunks.begin(), chunks.end(), 0);
  return chunks;
}

// One chunk is one of many at once; all chunks have this machine for themselves.
int jobs_asked(const RunArguments& arguments) {
  if (arguments.jobs > 0) return arguments.jobs;
  return arguments.all ? static_cast<int>(std::max(1U, std::thread::hardware_concurrency())) : 1;
}

Exit run_batch(const RunArguments& arguments, const Console& console) {
  const batch::BatchDirectory directory(arguments.directory);
  batch::RunOptions options = arguments.options;
  options.jobs = jobs_asked(arguments);
  // This very program, also where another version is put in its place meanwhile.
  options.program = arguments.program.empty() ? fs::path("/proc/self/exe") : fs::absolute(arguments.program);
  batch::RunHooks hooks;
  hooks.progress = [&console](std::size_t done, std::size_t all) {
    console.report_progress(fmt::format("{} of {} plans", done, all),
                            all > 0 ? static_cast<double>(done) / static_cast<double>(all) : 1);
  };
  hooks.failed = [&console](const batch::Failure& f) {
    console.warn(fmt::format("failed: panel {} (job {}): {}, {} tries{}", f.panel, f.job, f.why, f.attempts,
                             f.last_lines.empty() ? "" : ": " + f.last_lines.back()));
  };
  hooks.stop = [] { return interrupted(); };
  const batch::RunReport report =
      batch::run_chunks(directory, chunks_asked(arguments, batch::read_batch(directory)), options, hooks);
  console.end_progress();
  std::cout << fmt::format("plans {}, of them with a result before {}, planned {}, failed {}\n", report.plans,
                           report.there, report.planned, report.failures.size());
  return report.failures.empty() ? Exit::kOk : Exit::kInternal;
}

void add_batch_run(CLI::App& batch, const Console& console, Action& action) {
  auto arguments = std::make_shared<RunArguments>();
  auto* command = batch.add_subcommand("run", "Plan the jobs of a chunk, or all, that have no result");
  add_batch_directory(*command, arguments->directory);
  command->add_option("--chunk", arguments->chunk, "The chunk to plan, from 0")
      ->check(CLI::Range(0, kMostChunkNumber))
      ->type_name("K");
  command->add_flag("--all", arguments->all, "All chunks, on this machine");
  command
      ->add_option("--jobs", arguments->jobs, "Plans at once, a core each (default: 1; with --all all cores)")
      ->check(CLI::Range(1, kMostThreads))
      ->type_name("J");
  command->add_option("--limit-s", arguments->options.limit_s, "Time that a plan may take")
      ->check(CLI::Range(0.1, kLongestLimitS))
      ->type_name("S");
  command->add_option("--limit-mb", arguments->options.limit_mb, "Memory that a plan may take")
      ->check(CLI::Range(kLeastLimitMb, kMostLimitMb))
      ->type_name("MB");
  command
      ->add_option("--program", arguments->program,
                   "Start this program as hotblade, as a container's wrapper (default: this one)")
      ->check(CLI::ExistingFile)
      ->type_name("FILE");
  command->footer(
      "Exit code 1 when a job has failed three times; it is named, and the others are planned.\n"
      "Example: hotblade batch run facade --all");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return run_batch(*arguments, console); };
  });
}

// Of plans that passed: `: green 3, amber 1`.
std::string colors_text(const std::map<std::string, std::size_t>& colors) {
  std::string text;
  for (const auto& [color, count] :
       std::map<std::string, std::size_t, std::greater<>>(colors.begin(), colors.end()))
    text += fmt::format("{} {} {}", text.empty() ? ":" : ",", color, count);
  return text;
}

std::string table(const batch::BatchStatus& status) {
  std::string text = fmt::format("jobs {}, plans {}, with a result {}\n", status.batch.jobs,
                                 status.batch.plans, status.results);
  for (const auto& [verdict, count] : status.verdicts) {
    text += fmt::format("  {} {}", verdict, count);
    if (verdict == batch::kPassed) text += colors_text(status.colors);
    text += "\n";
  }
  text += fmt::format("chunks {}, done {}\n", status.batch.chunks, status.chunks_done);
  for (const batch::Failure& f : status.failures)
    text += fmt::format("failed: panel {} (job {}): {}, {} tries\n", f.panel, f.job, f.why, f.attempts);
  if (status.results < status.batch.plans)
    text += fmt::format("left {:.3g} min on one core, by estimate\n", status.left_s / 60);
  return text;
}

std::string status_json(const batch::BatchStatus& status) {
  return json_text(to_json(status), 2) + "\n";
}

void add_batch_status(CLI::App& batch, Action& action) {
  auto directory = std::make_shared<std::string>();
  auto as_json = std::make_shared<bool>(false);
  auto* command =
      batch.add_subcommand("status", "Say how many plans have results, by verdict, and what failed");
  add_batch_directory(*command, *directory);
  command->add_flag("--json", *as_json, "Print JSON instead of a table");
  command->footer("Example: hotblade batch status facade");
  command->callback([directory, as_json, &action] {
    action = [directory, as_json] {
      const batch::BatchStatus status = batch::status_of(batch::BatchDirectory(*directory));
      std::cout << (*as_json ? status_json(status) : table(status));
      return Exit::kOk;
    };
  });
}

Exit gather_batch(const std::string& directory, bool partial, const Console& console) {
  batch::GatherHooks hooks;
  hooks.progress = [&console](double share) { console.report_progress("gather", share); };
  hooks.stop = [] { return interrupted(); };
  const batch::GatherReport report = batch::gather(batch::BatchDirectory(directory), partial, hooks);
  console.end_progress();
  std::cout << fmt::format("jobs {}, without a result {}\npage {}\n", report.jobs, report.missing,
                           (fs::path(directory) / "index.html").string());
  return Exit::kOk;
}

void add_batch_gather(CLI::App& batch, const Console& console, Action& action) {
  auto directory = std::make_shared<std::string>();
  auto partial = std::make_shared<bool>(false);
  auto* command = batch.add_subcommand("gather", "Write results.csv, results.sqlite and index.html");
  add_batch_directory(*command, *directory);
  command->add_flag("--partial", *partial, "Also while jobs are without a result");
  command->footer("Example: hotblade batch gather facade");
  command->callback([directory, partial, &console, &action] {
    action = [directory, partial, &console] { return gather_batch(*directory, *partial, console); };
  });
}

}  // namespace

void add_batch_work(CLI::App& batch, const Console& console, Action& action) {
  add_batch_run(batch, console, action);
  add_batch_status(batch, action);
  add_batch_gather(batch, console, action);
}

}  // namespace hotblade::pipeline
