// hotblade ribs: rib curves with their ids, for templates and CAD.
#include <CLI/CLI.hpp>
#include <memory>

#include "pipeline/cli/command.hpp"
#include "pipeline/cli/ends_on_signal.hpp"
#include "pipeline/export/rib_files.hpp"

namespace hotblade::pipeline {
namespace {

struct RibsArguments {
  std::string program, format, output;
  RibFileOptions options;
  bool force = false;
};

Exit run_ribs(const RibsArguments& arguments, const Console& console) {
  constexpr const char* kSaid = "interrupted: nothing was written";
  std::vector<ExportedFile> files;
  {
    const EndsOnSignal ends(console, kSaid);
    files = rib_files(read_program(arguments.program), arguments.format, arguments.options);
  }
  if (files.empty()) throw Error(ErrorKind::kBadInput, arguments.program + ": has no ribs: plan it again");
  write_exported(files, arguments.output, arguments.force, [] { expect_not_interrupted(kSaid); });
  return Exit::kOk;
}

}  // namespace

void add_ribs(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<RibsArguments>();
  auto* command = app.add_subcommand("ribs", "Write the rib curves with their ids, for templates and CAD");
  command->add_option("program", arguments->program, "A program.json")->required()->type_name("FILE");
  command->add_option("--format", arguments->format, "What to write")
      ->required()
      ->check(CLI::IsMember({"dxf", "svg", "csv", "gcode"}))
      ->type_name("dxf|svg|csv|gcode");
  command->add_option("-o,--output", arguments->output, "Directory for the files")
      ->required()
      ->type_name("DIR");
  command->add_flag("--arcs", arguments->options.arcs, "Circular arcs of the ribs' lengths, not chords");
  command->add_option("--tolerance", arguments->options.tolerance_mm, "Largest distance to the rib in mm")
      ->check(CLI::Range(1e-6, 100.0))
      ->type_name("MM");
  command->add_flag("--force", arguments->force, "Overwrite files that are there");
  command->footer("Example: hotblade ribs vault_cut/program.json --format dxf --arcs -o vault_ribs");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return run_ribs(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
