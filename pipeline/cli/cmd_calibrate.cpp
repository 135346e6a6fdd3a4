// hotblade calibrate: from scans of a cut to what the cell does otherwise than planned.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <utility>

#include "pipeline/calibrate/calibration.hpp"
#include "pipeline/calibrate/cell_errors.hpp"
#include "pipeline/calibrate/scan_file.hpp"
#include "pipeline/calibrate/simulated_scan.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/ends_on_signal.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/settings/assignments.hpp"
#include "pipeline/verify/as_cut.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;

struct CalibrateArguments {
  std::string program, log, units = "mm", placement = "search", output, save_scan;
  std::vector<std::string> scans, assignments;
  bool rehearse = false, json = false, force = false;
  ScanRehearsal how;
};

constexpr const char* kDefaultOutput = "calibration.toml";

ScanPlacement placement_named(const std::string& word) {
  if (word == "near") return ScanPlacement::kNear;
  return word == "fixed" ? ScanPlacement::kFixed : ScanPlacement::kSearch;
}

std::vector<std::string> strip_ids(const Program& program) {
  std::vector<std::string> ids;
  for (const Strip& strip : program.strips) ids.push_back(strip.id);
  return ids;
}

// "S002=cut.ply", or a file alone where there is one strip.
MeasuredCut measured_cut(const std::string& given, const Program& program, const std::string& units) {
  const std::vector<std::string> ids = strip_ids(program);
  MeasuredCut cut;
  cut.file = given;
  const std::size_t equals = given.find('=');
  const auto named =
      equals == std::string::npos ? ids.end() : std::find(ids.begin(), ids.end(), given.substr(0, equals));
  if (named != ids.end()) {
    cut.strip = static_cast<std::size_t>(named - ids.begin());
    cut.file = given.substr(equals + 1);
  } else if (equals != std::string::npos && !fs::exists(given)) {
    throw Error(ErrorKind::kBadSettings,
                fmt::format("--scan {}: names no strip of the program ({}): say --scan {}=FILE", given,
                            fmt::join(ids, ", "), ids.front()));
  } else if (ids.size() > 1) {
    throw Error(ErrorKind::kBadSettings,
                fmt::format("--scan {}: names no strip (of {}): say which it is of, as --scan {}=FILE", given,
                            fmt::join(ids, ", "), ids.front()));
  }
  cut.points = read_scan(cut.file, units);
  return cut;
}

// A scan that counts twice would be trusted twice.
void expect_each_once(const std::vector<MeasuredCut>& cuts) {
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (cuts[i].points == cuts[j].points)
        throw Error(ErrorKind::kBadSettings, "--scan " + cuts[i].file + ": has the points of " +
                                                 cuts[j].file + ": give each scan once");
    }
  }
}

// Only those strips were cut that are scanned.
StripJobs scanned_strips(StripJobs work, const std::vector<MeasuredCut>& cuts) {
  StripJobs scanned;
  scanned.program = std::move(work.program);
  std::vector<Strip> strips = std::exchange(scanned.program.strips, {});
  for (std::size_t s = 0; s < strips.size(); ++s) {
    const bool is = std::any_of(cuts.begin(), cuts.end(), [&](const MeasuredCut& c) { return c.strip == s; });
    if (!is) continue;
    scanned.program.strips.push_back(std::move(strips[s]));
    scanned.jobs.push_back(std::move(work.jobs[s]));
  }
  return scanned;
}

// The program with the poses that were executed of the strips that are scanned, and the scans by its strips.
Program executed_program(const CalibrateArguments& arguments, std::vector<MeasuredCut>& cuts) {
  StripJobs work = read_strip_jobs(arguments.program, true);
  const std::vector<std::string> all = strip_ids(work.program);
  work = scanned_strips(std::move(work), cuts);
  const std::vector<std::string> ids = strip_ids(work.program);
  for (MeasuredCut& cut : cuts)
    cut.strip = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), all[cut.strip]) - ids.begin());
  return as_executed(work.program, read_executed(work, arguments.log));
}

// A setting of the job would change nothing of the cell that is rehearsed.
void expect_of_cell(const std::vector<std::string>& assignments) {
  const std::vector<std::string>& known = cell_keys();
  for (const std::string& assignment : assignments) {
    const std::string key = assignment.substr(0, assignment.find('='));
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw Error(ErrorKind::kBadSettings, fmt::format("--set {}: says nothing of the cell: give one of {}",
                                                       assignment, fmt::join(known, ", ")));
  }
}

// The first strip, as a cell would cut it that is as --set says, seen by a scanner.
std::vector<MeasuredCut> rehearsed(const CalibrateArguments& arguments, const Program& program,
                                   ErrorVector& truth) {
  const Settings settings = with_assignments(program.settings, arguments.assignments);
  expect_of_cell(arguments.assignments);
  truth = errors_of(program, settings);
  std::vector<MeasuredCut> cuts;
  for (std::size_t s = 0; s < program.strips.size(); ++s) {
    ScanRehearsal how = arguments.how;
    how.moved = placement_named(arguments.placement) == ScanPlacement::kSearch;
    how.seed += s;
    cuts.push_back(
        {s, "rehearsed scan of " + program.strips[s].id, rehearsed_scan(program, s, truth, how).points});
  }
  return cuts;
}

void expect_what_goes_together(const CalibrateArguments& arguments) {
  if (arguments.rehearse && !arguments.log.empty())
    throw Error(ErrorKind::kBadSettings,
                "--log: is not taken with --rehearse: a rehearsed cut goes as it was planned");
  if (!arguments.rehearse && !(arguments.assignments.empty() && arguments.save_scan.empty()))
    throw Error(ErrorKind::kBadSettings,
                std::string(arguments.assignments.empty() ? "--save-scan" : "--set") +
                    ": is of --rehearse: without it the scan says what the cell is like");
  if (arguments.rehearse == arguments.scans.empty()) return;
  throw Error(ErrorKind::kBadSettings,
              arguments.rehearse
                  ? "--scan: is not taken with --rehearse, which makes its own"
                  : "--scan: is missing: say --scan FILE, or --rehearse to try it without one");
}

Exit calibrate_cell(const CalibrateArguments& arguments, const Console& console) {
  expect_what_goes_together(arguments);
  const EndsOnSignal ends(console, "interrupted: nothing was written");
  const bool writes = !arguments.rehearse || !arguments.output.empty();
  const fs::path output = arguments.output.empty() ? kDefaultOutput : arguments.output;
  if (writes) expect_writable(output, arguments.force);
  if (!arguments.save_scan.empty()) expect_writable(arguments.save_scan, arguments.force);
  Program program = read_program(arguments.program);
  console.report_progress("read", 0.1);
  ErrorVector truth = ErrorVector::Zero();
  std::vector<MeasuredCut> scans;
  if (arguments.rehearse) {
    scans = rehearsed(arguments, program, truth);
    if (!arguments.save_scan.empty())
      write_file_atomically(arguments.save_scan, scan_csv(scans.front().points), arguments.force);
  }
  for (const std::string& given : arguments.scans)
    scans.push_back(measured_cut(given, program, arguments.units));
  expect_each_once(scans);
  if (!arguments.log.empty()) program = executed_program(arguments, scans);
  console.report_progress("register", 0.2);
  const Calibration calibration = calibrate(program, scans, placement_named(arguments.placement));
  if (writes) write_file_atomically(output, calibration_toml(program, calibration), arguments.force);
  console.report_progress("done", 1);
  const ErrorVector* known = arguments.rehearse ? &truth : nullptr;
  std::cout << (arguments.json ? to_json(calibration, known) + "\n" : describe(calibration, known));
  if (writes && !arguments.json) std::cout << "calibration " << output.string() << "\n";
  return Exit::kOk;
}

void add_rehearsal(CLI::App& command, CalibrateArguments& arguments) {
  command.add_flag("--rehearse", arguments.rehearse,
                   "Without a scan: make one of a cell that is off by what --set says, and calibrate by it");
  command
      .add_option("--set", arguments.assignments,
                  "Of the rehearsed cell: a setting it really has, as "
                  "blade.length_error_mm=1")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command.add_option("--noise", arguments.how.noise_mm, "Of a rehearsed point, mm (default: 0.2)")
      ->check(CLI::Range(0.0, 10.0))
      ->type_name("MM");
  command.add_option("--points", arguments.how.points, "Of a rehearsed scan (default: 5000)")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000}));
  command
      .add_option("--seen", arguments.how.seen, "Share of the cut that a rehearsed scan sees (default: 1)")
      ->check(CLI::Range(0.01, 1.0))
      ->type_name("SHARE");
  command.add_option("--seed", arguments.how.seed, "Of a rehearsed scan's chance (default: 1)");
  command.add_option("--save-scan", arguments.save_scan, "Write the rehearsed scan of the first strip")
      ->type_name("CSV");
}

}  // namespace

void add_calibrate(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<CalibrateArguments>();
  auto* command =
      app.add_subcommand("calibrate", "Find from a scan of a cut what the cell does otherwise than planned");
  command->add_option("program", arguments->program, "program.json that was cut")
      ->required()
      ->type_name("PROGRAM");
  command
      ->add_option("--scan", arguments->scans,
                   "Points of the cut, PLY or CSV; of several strips each as S001=FILE")
      ->allow_extra_args(false)
      ->type_name("[STRIP=]FILE");
  command->add_option("--log", arguments->log, "Execution log of the cut (default: it went as planned)")
      ->type_name("JSONL");
  command->add_option("--units", arguments->units, "Of the scans (default: mm)")
      ->check(CLI::IsMember({"mm", "cm", "m", "in", "ft"}))
      ->type_name("mm|cm|m|in|ft");
  command
      ->add_option("--placement", arguments->placement,
                   "Where the scans stand: anywhere, near the design's frame, or in it by the block's marks")
      ->check(CLI::IsMember({"search", "near", "fixed"}))
      ->type_name("search|near|fixed");
  command->add_option("-o,--output", arguments->output, "The settings found (default: calibration.toml)")
      ->type_name("TOML");
  command->add_flag("--force", arguments->force, "Write over a file that is there");
  command->add_flag("--json", arguments->json, "The result as one JSON object");
  add_rehearsal(*command, *arguments);
  command->footer(
      "Writes settings that `plan --config` takes beside a job's own. Exit code 3, and nothing written, when "
      "the scan "
      "does not fit the cut, fits it as well from several sides, or tells nothing.\n"
      "Example: hotblade calibrate vault_cut/program.json --rehearse --placement fixed --set "
      "blade.length_error_mm=1");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return calibrate_cell(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
