// hotblade export: the surface as cut, waypoints and robot programs for other software.
#include <CLI/CLI.hpp>
#include <memory>

#include "pipeline/cli/command.hpp"
#include "pipeline/export/robot_programs.hpp"
#include "pipeline/export/surface_files.hpp"
#include "pipeline/export/waypoint_files.hpp"

namespace hotblade::pipeline {
namespace {

struct ExportArguments {
  std::string program, format, output;
  double sample_mm = 2.5;
  bool force = false, override_refusal = false;
};

std::vector<ExportedFile> exported(const Program& program, const ExportArguments& arguments) {
  if (arguments.format == "obj") return {as_cut_obj(program, arguments.sample_mm)};
  if (arguments.format == "ply") return {as_cut_ply(program, arguments.sample_mm)};
  if (arguments.format == "csv") return waypoint_csv(program);
  if (arguments.format == "joints") return joints_csv(program);
  if (arguments.format == "compas") return waypoint_compas(program);
  if (arguments.format == "rapid") return rapid_programs(program);
  return krl_programs(program);
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

Exit run_export(const ExportArguments& arguments) {
  const Program program = read_program(arguments.program);
  expect_runnable(program, arguments);
  const std::vector<ExportedFile> files = exported(program, arguments);
  write_exported(files, arguments.output, arguments.force);
  return Exit::kOk;
}

}  // namespace

void add_export(CLI::App& app, const Console&, Action& action) {
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
  command->add_flag("--force", arguments->force, "Overwrite files that are there");
  command->add_flag("--override", arguments->override_refusal, "Export a refused program all the same");
  command->footer(
      "rapid and krl are text for two synchronised arms, not tested on hardware.\n"
      "Example: hotblade export job/program.json --format rapid -o job/robots");
  command->callback([arguments, &action] { action = [arguments] { return run_export(*arguments); }; });
}

}  // namespace hotblade::pipeline
