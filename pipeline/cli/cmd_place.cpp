// hotblade place: the arms of a cell for a finished program.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/info.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <utility>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/cli/backend_option.hpp"
#include "pipeline/cli/cell_word.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/ends_on_signal.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/plan/placed_plan.hpp"
#include "pipeline/program/design_file.hpp"
#include "pipeline/report/emit.hpp"
#include "pipeline/verify/motion_check.hpp"

namespace hotblade::pipeline {
namespace {

struct PlaceArguments {
  std::string program, cell, output, how, design;
  bool force = false, gzip = false;
};

// A program that was refused has other worries than its arms.
void expect_passed(const Program& program, const std::string& file) {
  if (program.verification.status == VerificationStatus::kPassed) return;
  throw Error(ErrorKind::kNotCuttable, file + ": the plan's status is " + name(program.verification.status) +
                                           ": plan again before arms are looked for");
}

// Arms are found for a motion that can be cut: they follow its clamps wherever these go.
bool motion_holds(const Program& program, const Console& console) {
  const std::vector<MotionBreach> breaches = check_motion(program);
  for (const MotionBreach& breach : breaches) console.warn("refused: " + breach.text);
  return breaches.empty();
}

// What was told of the program before and cannot be made without its plan.
void tell_left_out(const Emitted& emitted, const std::filesystem::path& directory, const Console& console) {
  if (emitted.left_out.empty()) return;
  console.warn(fmt::format(
      "warning: {}: of the program before, and gone: {}: `hotblade plan --cell` writes them of a new one",
      directory.string(), fmt::join(emitted.left_out, ", ")));
}

// Measures the cut again where the arms have changed it: what the program says is what its motion cuts.
// Returns the backend that measured; empty where the cut is as it was.
std::string measure_changed(const PlaceArguments& arguments, const Program& before, const Console& console,
                            ArmedProgram& armed) {
  if (!cuts_otherwise(armed.program, before)) return "";
  console.note("the arms change the blade's speed, and it melts by that: the cut is measured again");
  const std::filesystem::path file = given_or_at_hand(arguments.design, arguments.program, before);
  const surface::DesignSurface design = read_design_of(before, file);
  const gpu::Backend backend = backend_named("auto");
  PlanResult result = plan_of(std::move(armed.program));
  measure_again(design, backend, result);
  tell_backend(result.verification, backend, console);
  armed.program = std::move(result.program);
  armed.report.refusals = std::move(result.refusals);
  armed.report.warnings.insert(armed.report.warnings.end(), result.warnings.begin(), result.warnings.end());
  return backend_text(result.verification);
}

Exit place(const PlaceArguments& arguments, const Console& console) {
  const auto start = std::chrono::steady_clock::now();
  const std::filesystem::path directory = arguments.output;
  robot::Cell cell = read_cell(arguments.cell);
  if (arguments.how == "fixed") cell.place.how = robot::Placing::kFixed;
  if (arguments.how == "raise") cell.place.how = robot::Placing::kRaise;
  if (arguments.how == "search") cell.place.how = robot::Placing::kSearch;
  const Program program = read_program(arguments.program);
  expect_passed(program, arguments.program);
  if (!motion_holds(program, console)) return Exit::kNotCuttable;
  // A directory that is not there yet is made for a result alone.
  OutputSet output(directory, arguments.force);
  const EndsOnSignal ends(console, "interrupted: nothing was written",
                          [&output] { return output.abandon(); });
  ArmedProgram armed = with_arms(program, cell);
  RunFacts facts;
  if (armed.report.refusals.empty()) facts.backend = measure_changed(arguments, program, console, armed);
  for (const std::string& line : armed.report.warnings) console.warn("warning: " + line);
  for (const Refusal& refusal : armed.report.refusals) console.warn("refused: " + describe(refusal));
  if (!armed.report.refusals.empty()) return Exit::kNotCuttable;
  facts.design_path = arguments.design;
  if (facts.design_path.empty()) facts.design_path = design_path(arguments.program, program).value_or("");
  if (!facts.design_path.empty()) facts.design_path = std::filesystem::absolute(facts.design_path);
  facts.cell = kept_cell(arguments.cell);
  facts.threads = tbb::info::default_concurrency();
  facts.total_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string arms = describe_arms(armed.program);
  const Emitted emitted = emit_placed(std::move(armed.program), output, facts, arguments.gzip);
  tell_left_out(emitted, directory, console);
  std::cout << arms << "program " << (directory / program_name(arguments.gzip)).string() << "\nsheets "
            << (directory / "sheets.html").string() << "\n";
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
  command->add_option("-o,--output", arguments->output, "Directory for the new program and its sheets")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--place", arguments->how,
                   "Instead of the cell's own: may blocks be raised, moved and turned?")
      ->check(CLI::IsMember({"fixed", "raise", "search"}))
      ->type_name("fixed|raise|search");
  command
      ->add_option("--design", arguments->design,
                   "The design's file, where a blade that melts by its speed is measured again (default: "
                   "beside the program, or as planned)")
      ->type_name("FILE");
  command->add_flag("--gzip", arguments->gzip, "Write program.json.gz, a quarter as large");
  command->add_flag("--force", arguments->force, "Overwrite results that are there");
  command->footer(
      "Curves stay as they are, waypoints are met later where joints ask for it; a blade that melts by its "
      "speed is measured again then. Exit code 4 when a strip's "
      "arms cannot do it, or what it cuts then is over the tolerance: which, when and by how "
      "much.\n"
      "Example: hotblade place vault_cut/program.json --cell two_irb4600 -o vault_armed");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return place(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
