// hotblade study: re-runs of the papers' experiments, our figures beside theirs.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "pipeline/cli/command.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/settings/json_text.hpp"
#include "pipeline/study/study.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;

struct StudyArguments {
  study::StudyOptions options;
  std::string output;
  int jobs = 0;
  bool json = false, force = false;
};

// Larger samples would outgrow the memory that a study keeps its curves in.
constexpr std::size_t kMostSamples = 100'000'000;

Exit run_study(const study::Study& study, const StudyArguments& arguments, const Console& console) {
  const int threads = arguments.jobs > 0 ? arguments.jobs : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  const fs::path directory = arguments.output;
  const fs::path table = directory / (std::string(study.name) + ".json");
  if (!directory.empty()) {
    ensure_directory(directory);
    expect_writable(table, arguments.force);
  }
  study::StudyOptions options = arguments.options;
  options.progress = [&console, &study](double share) {
    console.report_progress(study.name, share);
    if (interrupted()) throw Error(ErrorKind::kInterrupted, "interrupted");
  };
  const study::StudyReport report = study.run(options);
  console.end_progress();
  const std::string figures = json_text(report.figures, 2) + "\n";
  if (!directory.empty()) {
    for (const study::StudyFile& file : report.files) {
      write_file_atomically(directory / file.name, file.bytes, arguments.force);
      console.note("written " + (directory / file.name).string());
    }
    write_file_atomically(table, figures, arguments.force);
    console.note("written " + table.string());
  }
  for (const std::string& remark : report.remarks) console.note(remark);
  std::cout << (arguments.json ? figures : report.text);
  return Exit::kOk;
}

}  // namespace

void add_study(CLI::App& app, const Console& console, Action& action) {
  auto* command = app.add_subcommand("study", "Re-run the papers' experiments and print ours beside theirs");
  command->require_subcommand(1);
  command->footer(
      "Same options, same bytes, whatever the number of threads.\nExample: hotblade study zone -o plots");
  for (const study::Study& study : study::studies()) {
    auto arguments = std::make_shared<StudyArguments>();
    auto* one = command->add_subcommand(study.name, study.about);
    one->add_option("--samples", arguments->options.samples,
                    "Curves of the main sample (default: the study's own)")
        ->check(CLI::Range(std::size_t{1}, kMostSamples));
    one->add_option("--checked", arguments->options.checked,
                    "Curves that a slower method checks (default: the study's own)")
        ->check(CLI::Range(std::size_t{1}, kMostSamples));
    one->add_option("--seed", arguments->options.seed, "Seed of the random curves")->capture_default_str();
    one->add_flag("--json", arguments->json, "Print the figures as JSON");
    one->add_option("-o,--output", arguments->output,
                    "Directory for plots and figures (default: none written)")
        ->type_name("DIR");
    one->add_option("--jobs", arguments->jobs, "Threads (default: all cores)")
        ->check(CLI::Range(1, kMostThreads));
    one->add_flag("--force", arguments->force, "Overwrite results that are there");
    one->footer(fmt::format("Example: hotblade study {0} --seed 2 --samples 500 --checked 20 -o {0}_plots",
                            study.name));
    one->callback([&action, &console, &study, arguments] {
      action = [&console, &study, arguments] { return run_study(study, *arguments, console); };
    });
  }
}

}  // namespace hotblade::pipeline
