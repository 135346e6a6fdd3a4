// hotblade batch: thousands of panels, planned on one machine or many.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "pipeline/batch/init.hpp"
#include "pipeline/cli/batch_commands.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/settings_options.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;

struct InitArguments {
  std::string directory;
  batch::Asked asked;
  SettingsSources sources;
  bool update = false;
  std::vector<std::string> given;  // options that say what the batch is to be
};

// A chunk shorter than a second or longer than a week is a slip of the keyboard.
constexpr double kLeastChunkMinutes = 0.02, kMostChunkMinutes = 10080;

std::string absolute_or_empty(const std::string& path) {
  return path.empty() ? path : fs::absolute(path).lexically_normal().string();
}

// What was asked; absent where an update repeats what the batch was asked before.
std::optional<batch::Asked> asked_in(const InitArguments& arguments) {
  batch::Asked asked = arguments.asked;
  if (asked.design.empty() == asked.list.empty()) {
    if (asked.design.empty() && arguments.update) {
      if (arguments.given.empty()) return std::nullopt;
      throw Error(ErrorKind::kBadSettings,
                  fmt::format("{}: without --design or --list, --update makes the batch as it was asked "
                              "before: give them too, or leave {} out",
                              arguments.given.front(), arguments.given.front()));
    }
    throw Error(ErrorKind::kBadSettings, "give --design OBJ or --list designs.csv, one of them");
  }
  if (!asked.list.empty() && asked.split != "none")
    throw Error(ErrorKind::kBadSettings, "--split parts one --design; a --list has a column `group`");
  if (asked.group_index > 0 && asked.split != "group")
    throw Error(ErrorKind::kBadSettings, "--group-index goes with --split group");
  asked.design = absolute_or_empty(asked.design);
  asked.list = absolute_or_empty(asked.list);
  asked.sweep_file = absolute_or_empty(asked.sweep_file);
  for (const fs::path& file : arguments.sources.files)
    asked.configs.push_back(absolute_or_empty(file.string()));
  asked.assignments = arguments.sources.assignments;
  return asked;
}

Exit make_batch(const InitArguments& arguments, const Console& console) {
  batch::InitHooks hooks;
  hooks.progress = [&console](const std::string& stage, double share) {
    console.report_progress(stage, share);
  };
  hooks.stop = [] { return interrupted(); };
  const batch::InitReport report = batch::init_batch(batch::BatchDirectory(arguments.directory),
                                                     asked_in(arguments), arguments.update, hooks);
  console.report_progress("done", 1);
  const batch::Batch& made = report.batch;
  std::cout << fmt::format("panels {}, of them {} different\njobs {}, plans {}, of them {} with a result\n",
                           made.panels, made.designs, made.jobs, made.plans, report.plans_there);
  std::cout << fmt::format("chunks {}, lists written {}\n", made.chunks, report.chunks_changed);
  std::cout << fmt::format("instruction set {}, estimate {:.3g} min on one core\n", made.simd,
                           made.estimate_s * static_cast<double>(made.plans - report.plans_there) / 60);
  return Exit::kOk;
}

void add_batch_init(CLI::App& batch, const Console& console, Action& action) {
  auto arguments = std::make_shared<InitArguments>();
  auto* command = batch.add_subcommand("init", "Split designs into panels and plans into chunks");
  batch::Asked& asked = arguments->asked;
  add_batch_directory(*command, arguments->directory);
  command->add_option("--design", asked.design, "One OBJ with all panels")->type_name("OBJ");
  command
      ->add_option("--split", asked.split,
                   "What is a panel: faces of a group, of an object, or that share vertices")
      ->check(CLI::IsMember({"group", "object", "component", "none"}))
      ->type_name("group|object|component|none");
  command
      ->add_option("--group-index", asked.group_index, "Which name counts where a g line has several, from 1")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  command->add_option("--list", asked.list, "Designs instead: path,units,up,group and settings as columns")
      ->type_name("CSV");
  command->add_option("--units", asked.units, "Unit of the OBJ's numbers; required here or as design.units")
      ->type_name("mm|cm|m|in|ft");
  command->add_option("--up", asked.up, "Axis of the OBJ that points up")->type_name("z|y");
  add_settings_options(*command, arguments->sources);
  command->add_option("--sweep", asked.sweeps, "Plan every panel with each of the values; sweeps multiply")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE,...");
  command->add_option("--sweep-file", asked.sweep_file, "Cases to plan: a column a key, a line a case")
      ->type_name("CSV");
  command->add_option("--chunk-minutes", asked.chunk_minutes, "Time of a chunk on one core, by estimate")
      ->check(CLI::Range(kLeastChunkMinutes, kMostChunkMinutes))
      ->type_name("MIN");
  command->add_option("--pictures", asked.pictures, "Pictures of each plan: none, a small one, or all")
      ->check(CLI::IsMember({batch::kPicturesNone, batch::kPicturesThumb, batch::kPicturesFull}))
      ->type_name("none|thumb|full");
  command->add_option("--keep", asked.keep, "Files of each plan: the reports, the program too, or all")
      ->check(CLI::IsMember({batch::kKeepReport, batch::kKeepProgram, batch::kKeepAll}))
      ->type_name("report|program|all");
  command->add_flag("--gzip", asked.gzip, "Keep programs as program.json.gz, a quarter as large");
  command->add_flag("--update", arguments->update,
                    "Bring a batch that is there up to date; without --design and --list, as asked before");
  command->footer("Example: hotblade batch init facade --design facade.obj --split group --units mm");
  command->callback([arguments, command, &console, &action] {
    for (const CLI::Option* option : command->get_options()) {
      if (option->count() == 0 || !option->nonpositional() || option->check_lname("update")) continue;
      arguments->given.push_back(option->get_name());
    }
    action = [arguments, &console] { return make_batch(*arguments, console); };
  });
}

}  // namespace

void add_batch_directory(CLI::App& command, std::string& directory) {
  command.add_option("directory", directory, "The batch's directory")->required()->type_name("DIR");
}

void add_batch(CLI::App& app, const Console& console, Action& action) {
  auto* batch = app.add_subcommand("batch", "Plan thousands of panels on one machine or many");
  batch->require_subcommand(1);
  batch->footer("Example: hotblade batch run facade --all");
  add_batch_init(*batch, console, action);
  add_batch_work(*batch, console, action);
}

}  // namespace hotblade::pipeline
