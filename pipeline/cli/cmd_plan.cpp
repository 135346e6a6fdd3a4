// hotblade plan: from a design to a verified cut program.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_invoke.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <future>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "pipeline/advice/design_trials.hpp"
#include "pipeline/cell/cell_file.hpp"
#include "pipeline/cli/backend_option.hpp"
#include "pipeline/cli/cell_word.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/ends_on_signal.hpp"
#include "pipeline/cli/settings_options.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/preview/drawing.hpp"
#include "pipeline/program/read_design.hpp"
#include "pipeline/report/emit.hpp"
#include "pipeline/report/json/report_json.hpp"
#include "pipeline/verify/largest_text.hpp"
#include "pipeline/verify/verdict.hpp"
#include "surface/read/design_surface.hpp"
#include "surface/read/self_crossings.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;

struct PlanArguments {
  DesignOptions design;
  std::string tolerance_mm, output, backend = "auto", pictures = "full", viewer, cell;
  int jobs = 0;
  bool force = false, override_refusal = false, strict = false, no_pictures = false, advise = false,
       json = false, gzip = false;
};

fs::path output_directory(const PlanArguments& arguments) {
  if (!arguments.output.empty()) return arguments.output;
  return fs::path(arguments.design.file).stem().string() + "_cut";
}

std::string strip_table(const PlanResult& result) {
  std::string text = fmt::format("{:<6}{:>6}{:>9}{:>11}{:>11}{:>10}{:>9}{:>9}\n", "strip", "ribs", "blade",
                                 "deviation", "radius", "margin", "cut", "machine");
  text +=
      fmt::format("{:<6}{:>6}{:>9}{:>11}{:>11}{:>10}{:>9}{:>9}\n", "", "", "mm", "mm", "mm", "", "s", "s");
  for (const StripFacts& f : result.strips) {
    text += fmt::format("{:<6}{:>6}{:>9.0f}{:>11.3f}{:>11.0f}{:>10.1f}{:>9.1f}{:>9.1f}\n", f.id, f.ribs,
                        f.blade_length_mm, f.deviation_max_mm, f.smallest_radius_mm(), f.smallest_margin,
                        f.motion.cut_s, f.motion.duration_s);
  }
  return text;
}

// Where the blocks stand; empty without blocks.
std::string plinth_line(const PlanResult& result) {
  if (result.strips.empty()) return "";
  const auto lower = [](const StripFacts& a, const StripFacts& b) { return a.plinth_mm < b.plinth_mm; };
  const auto [low, high] = std::minmax_element(result.strips.begin(), result.strips.end(), lower);
  const std::string low_text = fmt::format("{:.0f}", low->plinth_mm),
                    high_text = fmt::format("{:.0f}", high->plinth_mm);
  return fmt::format("blocks stand {}{} mm above the table\n", low_text,
                     high_text == low_text ? "" : " to " + high_text);
}

void print_summary(const PlanResult& result, const fs::path& program, const fs::path& report,
                   const Emitted& emitted) {
  const Verification& v = result.program.verification;
  const Deviation& d = v.deviation_mm;
  std::size_t ribs = 0;
  for (const StripFacts& f : result.strips) ribs += f.ribs;
  if (!result.strips.empty()) {
    std::cout << strip_table(result);
    std::cout << fmt::format("strips {}, ribs {}, at most {:.3g} mm apart\n", result.strips.size(), ribs,
                             result.spacing_mm);
    std::cout << plinth_line(result) << describe_arms(result.program);
  }
  if (result.verification.cut_samples == 0) {
    std::cout << "deviation not measured: nothing is cut\n";
  } else {
    std::cout << fmt::format(
        "deviation max {}, p99 {:.3f} mm, rms {:.3f} mm (tolerance {:.3g} mm), worst at "
        "({:.1f}, {:.1f}, {:.1f})\n",
        largest_and_bound_text(result.verification), d.p99, d.rms, v.tolerance_mm, d.at.x(), d.at.y(),
        d.at.z());
  }
  std::cout << fmt::format("uncut {:.0f} mm2 ({:.2f} % of the design)\n", v.uncut_mm2,
                           100 * result.verification.uncut_share());
  const Verdict verdict = verdict_of(result.program);
  const Paint paint = paint_of(verdict.color);
  if (result.verification.cut_samples > 0) std::cout << budget_text(verdict) << "\n";
  std::cout << "status " << painted(name(v.status), paint, STDOUT_FILENO) << "\n";
  std::cout << "verdict " << painted(name(verdict.color), paint, STDOUT_FILENO) << ": " << headline(verdict)
            << "\n";
  if (emitted.program_written) std::cout << "program " << program.string() << "\n";
  std::cout << "report " << report.string() << "\n";
}

void print_refusals(const PlanResult& result, const Console& console) {
  constexpr std::size_t kShown = 10;
  for (std::size_t i = 0; i < std::min(kShown, result.refusals.size()); ++i) {
    console.warn("refused: " + describe(result.refusals[i]));
  }
  if (result.refusals.size() > kShown) {
    console.warn(fmt::format("refused: {} more, see report.json", result.refusals.size() - kShown));
  }
}

// What was planned again and passed.
void tell_remedies(const PlanResult& result, bool asked, const Console& console) {
  if (result.refusals.empty()) return;
  if (asked || !result.remedies.empty()) {
    for (const std::string& line : tried_lines(result.remedies)) console.note(line);
  }
  if (!asked) console.note(kAdviseHint);
}

// What the shape suggests; what a fan's axis does to the design, the plan says.
std::vector<Suggestion> suggestions_for(surface::DesignSurface& design, const Settings& settings,
                                        const Console& console) {
  try {
    FirstLook look = first_look_of(design, settings);
    if (look.odd_size && !look.odd_size->hopeless) console.note(describe(*look.odd_size));
    return std::move(look.suggestions);
  } catch (const surface::FanError&) {
    return {};
  }
}

// Where in the command's progress its parts end. Pictures take a second, which is a third of a small plan.
constexpr double kRead = 0.02, kTried = 0.5, kPlanned = 0.82, kDrawn = 0.97;

// Progress of a part of the command, told as that of the whole.
std::function<void(const std::string&, double)> progress_within(const Console& console, double from,
                                                                double to) {
  return [&console, from, to](const std::string& stage, double share) {
    console.report_progress(stage, from + share * (to - from));
  };
}

constexpr const char* kInterrupted = "interrupted: nothing was written";

Exit plan_design(const PlanArguments& arguments, const Console& console) {
  const auto start = std::chrono::steady_clock::now();
  DesignOptions design_options = arguments.design;
  if (!arguments.tolerance_mm.empty()) {
    design_options.sources.flags.push_back({"--tolerance", "design.tolerance_mm", arguments.tolerance_mm});
  }
  const Settings settings = resolve_design(design_options);
  std::optional<robot::Cell> cell;
  if (!arguments.cell.empty()) cell = read_cell(arguments.cell);
  const int threads = arguments.jobs > 0 ? arguments.jobs : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));

  const Pictures asked =
      arguments.no_pictures ? Pictures::kNone : pictures_named(arguments.pictures).value_or(Pictures::kFull);
  console.report_progress("read", 0);
  std::optional<EndsOnSignal> ends(std::in_place, console, kInterrupted);
  // Beside the first file's reading, which leaves a core idle: pictures need not wait for it later.
  std::future<void> driver;
  if (asked != Pictures::kNone) {
    // TBB opens libraries when it first works. Were the driver being loaded, that would wait for all of it.
    tbb::parallel_invoke([] {}, [] {});
    driver = std::async(std::launch::async, preview::load_driver);
  }
  surface::DesignSurface design = read_design(design_options.file, settings.design);
  const Eigen::Vector3d size = design.health.bbox_mm[1] - design.health.bbox_mm[0];
  console.note(fmt::format("{}: {} triangles, {:.1f} x {:.1f} x {:.1f} mm ({}, {} up)", design_options.file,
                           design.health.triangles, size.x(), size.y(), size.z(), settings.design.units,
                           settings.design.up));
  for (const std::string& line : design.health.repairs) console.note("repaired: " + line);
  const std::vector<Suggestion> suggested = suggestions_for(design, settings, console);
  for (const std::string& line : design.health.warnings) console.warn("warning: " + line);
  refuse_blocked(design, design_options.file);
  ends.reset();
  const fs::path directory = output_directory(arguments);
  OutputSet output(directory, arguments.force);
  ends.emplace(console, kInterrupted, [&output] { return output.abandon(); });

  PlanHooks hooks;
  // Where it is refused, other settings may be tried.
  const bool may_try = arguments.advise || !suggested.empty();
  hooks.progress = progress_within(console, kRead, may_try ? kTried : kPlanned);
  hooks.backend = backend_named(arguments.backend);
  hooks.refused_too = arguments.override_refusal;
  // Sheets that cross do not stop a plan; they are looked for beside it.
  std::future<std::string> crossings =
      std::async(std::launch::async, [&] { return surface::self_crossings_text(design); });
  PlanResult result = plan(design, settings, hooks);
  if (cell) hold_in_cell(design, *cell, hooks.backend, result);
  if (const std::string text = crossings.get(); !text.empty()) {
    console.warn("warning: " + text);
    design.health.warnings.push_back(text);
  }
  const std::vector<std::string> found = result.warnings;  // the design's have been said
  for (const std::string& line : design.health.warnings) result.warnings.push_back(line);
  if (arguments.strict && !result.warnings.empty()) refuse_warnings(result);
  if (!result.refusals.empty()) {
    // What the shape alone suggests is tried unasked: it is the likeliest reason of all.
    const auto changes = arguments.advise ? likely_changes(result, suggested) : changes_by_shape(suggested);
    const ReadAgain read = [&](const DesignSettings& how) { return read_design(design_options.file, how); };
    int trial = 0;
    result.remedies = try_changes(settings, changes, [&](const Settings& changed) {
      const auto end = [](int trials) { return kTried + trials * (kPlanned - kTried) / kMostPlans; };
      hooks.progress = progress_within(console, end(trial), end(trial + 1));
      ++trial;
      return plan_again(read, changed, hooks, arguments.strict,
                        [&](const surface::DesignSurface& same, PlanResult& again) {
                          if (cell) hold_in_cell(same, *cell, hooks.backend, again);
                        });
    });
  }
  console.report_progress("draw", kPlanned);

  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const RunFacts facts{fs::absolute(design_options.file), kept_cell(arguments.cell),
                       backend_text(result.verification), threads, seconds};
  const auto pictures_of = [&](const PlanResult& planned) {
    const Viewer viewer =
        viewer_named(arguments.viewer).value_or(asked == Pictures::kFull ? Viewer::kFull : Viewer::kNone);
    const auto drawn = [&](double share) {
      console.report_progress(share < 1 ? "draw" : "write", kPlanned + share * (kDrawn - kPlanned));
    };
    if (driver.valid()) driver.get();
    ReportPictures pictures = take_pictures(planned, design, asked, viewer, drawn);
    console.report_progress("write", kDrawn);
    if (pictures.pictures.empty() && asked != Pictures::kNone)
      console.warn("warning: no pictures: " + pictures.note);
    return pictures;
  };
  const Emitted emitted =
      emit(result, output, facts, {arguments.override_refusal, arguments.gzip}, pictures_of);
  console.report_progress("done", 1);
  tell_backend(result.verification, hooks.backend, console);
  for (const std::string& line : found) console.warn("warning: " + line);
  print_refusals(result, console);
  tell_remedies(result, arguments.advise, console);
  if (arguments.json) {
    std::cout << report_json(result, emitted.program_sha256);
  } else {
    print_summary(result, directory / program_name(arguments.gzip), directory / "report.html", emitted);
  }
  return result.refusals.empty() ? Exit::kOk : Exit::kNotCuttable;
}

}  // namespace

void add_plan(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<PlanArguments>();
  auto* command = app.add_subcommand("plan", "Plan, verify and write the cut program of a design");
  add_design_options(*command, arguments->design);
  command->add_option("--tolerance", arguments->tolerance_mm, "Accepted deviation in mm; wins over settings")
      ->type_name("MM");
  command->add_option("-o,--output", arguments->output, "Directory for the results (default: NAME_cut)")
      ->type_name("DIR");
  command
      ->add_option("--cell", arguments->cell,
                   "Two arms to hold the plan against: a TOML file, two_irb4600 or two_kr50")
      ->type_name("CELL");
  command->add_option("--jobs", arguments->jobs, "Threads (default: all cores)")
      ->check(CLI::Range(1, kMostThreads));
  add_backend_option(*command, arguments->backend);
  command->add_flag("--json", arguments->json, "Print report.json instead of a table");
  command->add_flag("--force", arguments->force, "Overwrite results that are there");
  command->add_flag("--override", arguments->override_refusal,
                    "Write the program of a refused plan all the same, recorded in it; still exit code 4");
  command->add_flag("--no-pictures", arguments->no_pictures,
                    "No preview.png and scene.gltf, no pictures in report.html");
  command
      ->add_option("--pictures", arguments->pictures,
                   "full: all of them; thumb: a small preview.png alone; none: as --no-pictures")
      ->check(CLI::IsMember({"none", "thumb", "full"}))
      ->type_name("none|thumb|full");
  command
      ->add_option(
          "--viewer", arguments->viewer,
          "View in three dimensions in report.html: full (default), light for small files (default none "
          "with --pictures none and thumb)")
      ->check(CLI::IsMember({"full", "light", "none"}))
      ->type_name("full|light|none");
  command->add_flag("--gzip", arguments->gzip, "Write program.json.gz, a quarter as large");
  command->add_flag("--advise", arguments->advise,
                    "Plan a refused job again with settings that may help, and say which passed");
  command->add_flag("--strict", arguments->strict, "Exit code 4 on any warning");
  command->footer(
      "Exit code 4 when the design is not cuttable as asked: which strip, limit and amount is said.\n"
      "Example: hotblade plan vault.obj --units mm --config job.toml -o vault_cut");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return plan_design(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
