// hotblade place: the arms of a cell for a finished program.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/gzip.hpp"
#include "pipeline/report/output_set.hpp"

namespace hotblade::pipeline {
namespace {

struct PlaceArguments {
  std::string program, cell, output, how;
  bool force = false, gzip = false;
};

// A program that was refused has other worries than its arms.
void expect_passed(const Program& program, const std::string& file) {
  if (program.verification.status == VerificationStatus::kPassed) return;
  throw Error(ErrorKind::kNotCuttable, file + ": the plan's status is " + name(program.verification.status) +
                                           ": plan again before arms are looked for");
}

Exit place(const PlaceArguments& arguments, const Console& console) {
  const std::filesystem::path output = std::filesystem::path(arguments.output) / program_name(arguments.gzip);
  robot::Cell cell = read_cell(arguments.cell);
  if (arguments.how == "fixed") cell.place.how = robot::Placing::kFixed;
  if (arguments.how == "raise") cell.place.how = robot::Placing::kRaise;
  if (arguments.how == "search") cell.place.how = robot::Placing::kSearch;
  const Program program = read_program(arguments.program);
  expect_passed(program, arguments.program);
  // A directory that is not there yet is made for a result alone.
  if (std::error_code code; std::filesystem::exists(arguments.output, code))
    expect_writable(output, arguments.force);
  const ArmedProgram armed = with_arms(program, cell);
  for (const std::string& line : armed.report.warnings) console.warn("warning: " + line);
  for (const Refusal& refusal : armed.report.refusals) console.warn("refused: " + describe(refusal));
  if (!armed.report.refusals.empty()) return Exit::kNotCuttable;
  if (program.blade.melt.by_speed())
    console.warn(
        "warning: the arms may have made the blade slower, and it melts more then: measure the new program "
        "with "
        "`hotblade verify`, or plan with --cell");
  ensure_directory(arguments.output);
  const std::string text = to_json(armed.program);
  write_file_atomically(output, arguments.gzip ? packed(text) : text, arguments.force);
  std::cout << describe_arms(armed.program) << "program " << output.string() << "\n";
  return Exit::kOk;
}

}  // namespace

void add_place(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<PlaceArguments>();
  auto* command = app.add_subcommand("place", "Find the joints of two arms for a finished program");
  command->add_option("program", arguments->program, "A program.json")->required()->type_name("PROGRAM");
  command->add_option("--cell", arguments->cell, "The two arms: a TOML file, two_irb4600 or two_kr50")
      ->required()
      ->type_name("CELL");
  command->add_option("-o,--output", arguments->output, "Directory for the new program.json")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--place", arguments->how,
                   "Instead of the cell's own: may blocks be raised, moved and turned?")
      ->check(CLI::IsMember({"fixed", "raise", "search"}))
      ->type_name("fixed|raise|search");
  command->add_flag("--gzip", arguments->gzip, "Write program.json.gz, a quarter as large");
  command->add_flag("--force", arguments->force, "Overwrite a program that is there");
  command->footer(
      "Cuts stay as they are, waypoints are met later where joints ask for it. Exit code 4 when a strip's "
      "arms cannot do it: which, when and by how "
      "much.\n"
      "Example: hotblade place vault_cut/program.json --cell two_irb4600 -o vault_armed");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return place(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
