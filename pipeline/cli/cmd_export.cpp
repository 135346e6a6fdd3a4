// hotblade export: the surface as cut, waypoints and robot programs for other software.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/cli/cell_word.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/ends_on_signal.hpp"
#include "pipeline/export/robot_jobs.hpp"
#include "pipeline/export/robot_programs.hpp"
#include "pipeline/export/surface_files.hpp"
#include "pipeline/export/waypoint_files.hpp"
#include "pipeline/plan/arms/arms.hpp"

namespace hotblade::pipeline {
namespace {

struct ExportArguments {
  std::string program, format, output, cell, moves = "cartesian";
  double sample_mm = 2.5;
  bool force = false, override_refusal = false;
};

// The cell that a program's joints belong to; absent for a program of poses alone.
std::optional<robot::Cell> cell_of(const Program& program, const ExportArguments& arguments) {
  if (!program.cell) {
    if (arguments.cell.empty() && arguments.moves == "cartesian") return std::nullopt;
    throw Error(ErrorKind::kBadInput, arguments.program + ": the program has no joints: plan it with --cell");
  }
  if (arguments.cell.empty()) {
    throw Error(ErrorKind::kBadSettings, "--cell: the program's joints are those of the cell \"" +
                                             program.cell->name + "\": give " +
                                             cell_word(arguments.program, program));
  }
  robot::Cell cell = read_cell(arguments.cell);
  if (cell_sha256(cell) != program.cell->sha256) {
    throw Error(ErrorKind::kBadInput, arguments.program + ": the joints are those of another cell (" +
                                          program.cell->name + ", sha256 " + program.cell->sha256 +
                                          "), not of " + arguments.cell + ": hotblade place finds its own");
  }
  return cell;
}

std::vector<ExportedFile> robot_files(const Program& program, const ExportArguments& arguments,
                                      const Console& console) {
  const std::optional<robot::Cell> cell = cell_of(program, arguments);
  const RobotMoves moves = arguments.moves == "joint" ? RobotMoves::kJoint : RobotMoves::kCartesian;
  if (moves == RobotMoves::kJoint) {
    console.note(fmt::format("between waypoints the jaws leave their straight way by at most {:.3f} mm",
                             off_straight_mm(program, *cell)));
  }
  const robot::Cell* known = cell ? &*cell : nullptr;
  return arguments.format == "rapid" ? rapid_programs(program, known, moves)
                                     : krl_programs(program, known, moves);
}

std::vector<ExportedFile> exported(const Program& program, const ExportArguments& arguments,
                                   const Console& console) {
  if (arguments.format == "obj") return {as_cut_obj(program, arguments.sample_mm)};
  if (arguments.format == "ply") return {as_cut_ply(program, arguments.sample_mm)};
  if (arguments.format == "csv") return waypoint_csv(program);
  if (arguments.format == "joints") return joints_csv(program);
  if (arguments.format == "compas") return waypoint_compas(program);
  return robot_files(program, arguments, console);
}

// What moves a machine is not handed out for a job that was refused.
void expect_runnable(const Program& program, const ExportArguments& arguments) {
  const bool moves = arguments.format != "obj" && arguments.format != "ply";
  if (!moves || arguments.override_refusal || program.verification.status == VerificationStatus::kPassed)
    return;
  throw Error(ErrorKind::kNotCuttable, arguments.program + ": not to be run (status " +
                                           name(program.verification.status) +
                                           ", passed): plan again, or --override to export it all the same");
}

Exit run_export(const ExportArguments& arguments, const Console& console) {
  constexpr const char* kSaid = "interrupted: nothing was written";
  std::vector<ExportedFile> files;
  {
    const EndsOnSignal ends(console, kSaid);
    const Program program = read_program(arguments.program);
    expect_runnable(program, arguments);
    files = exported(program, arguments, console);
  }
  write_exported(files, arguments.output, arguments.force, [] { expect_not_interrupted(kSaid); });
  return Exit::kOk;
}

}  // namespace

void add_export(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<ExportArguments>();
  auto* command = app.add_subcommand("export", "Write the as-cut surface, waypoints or robot programs");
  command->add_option("program", arguments->program, "A program.json")->required()->type_name("FILE");
  command->add_option("--format", arguments->format, "What to write")
      ->required()
      ->check(CLI::IsMember({"obj", "ply", "csv", "joints", "compas", "rapid", "krl"}))
      ->type_name("obj|ply|csv|joints|compas|rapid|krl");
  command->add_option("-o,--output", arguments->output, "Directory for the files")
      ->required()
      ->type_name("DIR");
  command->add_option("--sample", arguments->sample_mm, "Grid step of the as-cut surface in mm")
      ->check(CLI::Range(0.1, 100.0))
      ->type_name("MM");
  command
      ->add_option("--cell", arguments->cell,
                   "For rapid and krl of a program with joints: its cell, whose names they take")
      ->type_name("CELL");
  command
      ->add_option("--moves", arguments->moves,
                   "For rapid and krl: moves by poses (cartesian, default) or by joints")
      ->check(CLI::IsMember({"cartesian", "joint"}))
      ->type_name("cartesian|joint");
  command->add_flag("--force", arguments->force, "Overwrite files that are there");
  command->add_flag("--override", arguments->override_refusal, "Export a refused program all the same");
  command->footer(
      "rapid and krl are text for two synchronised arms, not tested on hardware.\n"
      "Example: hotblade export vault_cut/program.json --format rapid -o vault_robots");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return run_export(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
