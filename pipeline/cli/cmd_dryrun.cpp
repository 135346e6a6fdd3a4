// hotblade dryrun: simulator and streaming in one, and the proof that what was executed is what was planned.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>

#include "pipeline/cli/command.hpp"
#include "pipeline/dryrun.hpp"

namespace hotblade::pipeline {
namespace {

struct DryRunArguments {
  std::string program, design, log;
  bool overridden = false;
};

// The log of a dry run: where the user wants it, or a temporary file that goes again.
class LogFile {
 public:
  explicit LogFile(const std::string& wanted) : path_(wanted), temporary_(wanted.empty()) {
    if (!temporary_ && std::filesystem::exists(path_)) {
      throw CommandError(Exit::kFile, wanted + ": is already there: choose another --log");
    }
    if (!temporary_) return;
    std::string name = (std::filesystem::temp_directory_path() / "hotblade-dryrun-XXXXXX").string();
    const int fd = ::mkstemp(name.data());
    if (fd < 0)
      throw CommandError(Exit::kFile, name + ": no temporary file can be made: set TMPDIR or give --log");
    ::close(fd);
    path_ = name;
  }
  ~LogFile() {
    std::error_code ignored;
    if (temporary_) std::filesystem::remove(path_, ignored);
  }
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  bool temporary_;
};

void require_design(const std::string& file, const Program& program) {
  if (file.empty()) return;
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.is_open() || stream.bad()) throw CommandError(Exit::kFile, file + ": cannot be read");
  const auto hash =
      robot::to_hex(robot::sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}));
  if (hash == program.design.sha256) return;
  throw CommandError(Exit::kBadInput, file + ": is not the design this program was planned for (sha256 " +
                                          hash.substr(0, 12) + ", " + program.design.sha256.substr(0, 12) +
                                          "): give " + program.design.file);
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

Exit dryrun(const DryRunArguments& arguments, const Console& console) {
  const StripJobs work = read_strip_jobs(arguments.program, arguments.overridden);
  require_design(arguments.design, work.program);
  const LogFile log(arguments.log);
  DryRunOptions options;
  options.log_file = log.path();
  options.limits = planned_limits(work.program);
  options.progress = [&](const std::string& strip, double fraction) {
    console.report_progress(strip, fraction);
  };
  options.interrupted = [] { return interrupted(); };
  console.note(
      "dry run: the simulator does not check the blade's equilibrium; plan checked its stability at every "
      "pose");
  const DryRunReport report = dry_run(work.jobs, options);
  console.end_progress();
  std::cout << table(report);
  if (report.interrupted) return Exit::kInterrupted;
  if (report.holds()) return Exit::kOk;
  const StripDryRun& last = report.strips.back();
  console.warn(last.stream.message.empty() ? last.strip + ": what was executed is not what was planned"
                                           : last.stream.message);
  return Exit::kController;
}

}  // namespace

void add_dryrun(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<DryRunArguments>();
  auto* command = app.add_subcommand("dryrun", "Stream a program to a simulator and prove what was executed");
  command->add_option("program", arguments->program, "The program.json to stream")
      ->required()
      ->type_name("PROGRAM");
  command->add_option("--design", arguments->design, "Refuse unless the program was planned for this OBJ")
      ->type_name("OBJ");
  command->add_option("--log", arguments->log, "Keep the execution log in this new file")->type_name("FILE");
  command->add_flag("--override", arguments->overridden, "Run a program that did not pass its verification");
  command->footer(
      "Exit code 0 when every waypoint was executed once, in order, byte for byte; 6 when not.\n"
      "Example: hotblade dryrun out/program.json");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return dryrun(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
