// hotblade dryrun: simulator and streaming in one, and the proof that what was executed is what was planned.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "pipeline/cli/cell_word.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/controller_cell.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/program/design_file.hpp"
#include "pipeline/run/dryrun.hpp"
#include "pipeline/settings/json_text.hpp"
#include "pipeline/verify/as_cut.hpp"

namespace hotblade::pipeline {
namespace {

struct DryRunArguments {
  std::string program, design, log, cell;
  bool overridden = false, json = false;
};

// The log of a dry run: a new file where the user wants it, which stays once it is written whole, or a
// temporary one that goes again.
class LogFile {
 public:
  explicit LogFile(const std::string& wanted) : path_(wanted), stays_(false), wanted_(!wanted.empty()) {
    if (wanted_) {
      make_new();
      return;
    }
    std::string name = (std::filesystem::temp_directory_path() / "hotblade-dryrun-XXXXXX").string();
    const int fd = ::mkstemp(name.data());
    if (fd < 0)
      throw Error(ErrorKind::kFile, name + ": no temporary file can be made: set TMPDIR or give --log");
    ::close(fd);
    path_ = name;
  }
  ~LogFile() {
    std::error_code ignored;
    if (!stays_) std::filesystem::remove(path_, ignored);
  }
  void written_whole() { stays_ = wanted_; }
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  // So that what is removed where it fails is its own.
  void make_new() const {
    const int fd = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (fd >= 0) {
      ::close(fd);
      return;
    }
    if (errno == EEXIST)
      throw Error(ErrorKind::kFile, path_.string() + ": is already there: choose another --log");
    throw Error(ErrorKind::kFile, path_.string() + ": the log cannot be written (" +
                                      std::generic_category().message(errno) + "): choose a writable place");
  }

  std::filesystem::path path_;
  bool stays_, wanted_;
};

// The design, when it is at hand.
std::optional<surface::DesignSurface> find_design(const DryRunArguments& arguments, const Program& program) {
  if (!arguments.design.empty()) return read_design_of(program, arguments.design);
  const auto found = design_at_hand(arguments.program, program);
  if (!found) return std::nullopt;
  return read_design_of(program, *found);
}

VerifyOptions as_cut_options(const Program& program) {
  VerifyOptions options;
  options.tolerance_mm = program.verification.tolerance_mm;
  options.max_uncut_share = program.settings.design.max_uncut_share;
  return options;
}

std::string table(const DryRunReport& report) {
  std::string text = fmt::format("{:<8}{:>10}{:>10}{:>9}{:>9}{:>10}\n", "strip", "planned", "executed",
                                 "bytes", "chain", "time");
  for (const StripDryRun& strip : report.strips) {
    text += fmt::format("{:<8}{:>10}{:>10}{:>9}{:>9}{:>10}\n", strip.strip, strip.proof.planned,
                        strip.proof.executed,
                        strip.proof.bytes_equal && strip.proof.in_order ? "equal" : "DIFFER",
                        strip.proof.chain_equal ? "equal" : "DIFFERS", clock_text(strip.planned_s));
  }
  return text;
}

std::string to_json(const DryRunReport& report, const std::string& as_cut,
                    const std::vector<std::string>& arms_unchecked) {
  nlohmann::ordered_json json;
  json["holds"] = report.holds();
  json["strips"] = nlohmann::ordered_json::array();
  for (const StripDryRun& strip : report.strips) {
    json["strips"].push_back({{"id", strip.strip},
                              {"planned", strip.proof.planned},
                              {"executed", strip.proof.executed},
                              {"in_order", strip.proof.in_order},
                              {"bytes_equal", strip.proof.bytes_equal},
                              {"chain_equal", strip.proof.chain_equal},
                              {"planned_s", strip.planned_s}});
  }
  json["as_cut"] = as_cut.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json::parse(as_cut);
  json["not_checked"] = nlohmann::ordered_json::array();
  if (as_cut.empty()) json["not_checked"].push_back("as-cut deviation");
  for (const std::string& item : arms_unchecked) json["not_checked"].push_back(item);
  return json_text(json, 2) + "\n";
}

// Measures what the log says was cut, and prints everything.
Exit judge(const StripJobs& work, const DryRunReport& report, const LogFile& log,
           const std::optional<surface::DesignSurface>& design, const robot::ArmCell* cell,
           const DryRunArguments& arguments) {
  const bool json = arguments.json, no_cell = work.program.cell && cell == nullptr;
  std::vector<std::string> arms_unchecked;
  if (cell != nullptr) arms_unchecked = not_looked_at(cell->cell());
  if (!json && report.holds()) {
    if (no_cell) std::cout << "arms: not checked, give " + cell_word(arguments.program, work.program) + "\n";
    for (const std::string& item : arms_unchecked) std::cout << "not checked: " + item + "\n";
  }
  if (no_cell) arms_unchecked.emplace_back("arms");
  if (!report.holds() || !design) {
    std::cout << (json ? to_json(report, "", arms_unchecked) : table(report));
    if (!json && report.holds())
      std::cout << "as cut: not checked, the design is not at hand: give --design " +
                       work.program.design.file + "\n";
    return report.holds() ? Exit::kOk : Exit::kController;
  }
  const VerifyOptions options = as_cut_options(work.program);
  const AsCutReport cut = as_cut(work.program, read_executed(work, log.path()), *design, options);
  std::cout << (json ? to_json(report, to_json(cut, options), arms_unchecked)
                     : table(report) + describe(cut, options));
  return cut.cut.within_tolerance ? Exit::kOk : Exit::kDeviation;
}

Exit dryrun(const DryRunArguments& arguments, const Console& console) {
  const StripJobs work = read_strip_jobs(arguments.program, arguments.overridden);
  const auto design = find_design(arguments, work.program);
  LogFile log(arguments.log);
  DryRunOptions options;
  options.log_file = log.path();
  options.limits = planned_limits(work.program);
  options.blade = planned_blade(work.program);
  options.arms = controller_cell(arguments.cell, work.program.settings.motion, &work);
  options.progress = [&](const std::string& strip, double fraction) {
    console.report_progress(strip, fraction);
  };
  options.interrupted = [] { return interrupted(); };
  const auto began = std::chrono::steady_clock::now();
  const DryRunReport report = dry_run(work.jobs, options);
  log.written_whole();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  console.end_progress();
  std::size_t waypoints = 0;
  for (const StripDryRun& strip : report.strips) waypoints += strip.proof.executed;
  console.note(fmt::format("dry run: {} waypoints in {:.1f} s, {:.0f} a second with every check on",
                           waypoints, seconds, static_cast<double>(waypoints) / seconds));
  const Exit exit = judge(work, report, log, design, options.arms.get(), arguments);
  if (report.interrupted) return Exit::kInterrupted;
  if (report.holds()) return exit;
  const StripDryRun& last = report.strips.back();
  console.warn(last.stream.message.empty() ? last.strip + ": what was executed is not what was planned"
                                           : last.stream.message);
  return exit;
}

}  // namespace

void add_dryrun(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<DryRunArguments>();
  auto* command = app.add_subcommand("dryrun", "Stream a program to a simulator and prove what was executed");
  command->add_option("program", arguments->program, "The program.json to stream")
      ->required()
      ->type_name("PROGRAM");
  command
      ->add_option("--design", arguments->design,
                   "The design's file, to measure what was cut (default: beside the program, or as planned)")
      ->type_name("FILE");
  command
      ->add_option("--cell", arguments->cell,
                   "Let the simulator check the arms of this cell: the one that the program was planned for")
      ->type_name("CELL");
  command->add_flag("--json", arguments->json, "The result as one JSON object");
  command->add_option("--log", arguments->log, "Keep the execution log in this new file")->type_name("FILE");
  command->add_flag("--override", arguments->overridden, "Run a program that did not pass its verification");
  command->footer(
      "Exit code 0 when every waypoint was executed once, in order, byte for byte, and the surface it cut is "
      "within "
      "the tolerance; 6 when not executed so, 5 when over the tolerance.\n"
      "Example: hotblade dryrun vault_cut/program.json");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return dryrun(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
