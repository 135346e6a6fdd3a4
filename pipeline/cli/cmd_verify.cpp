// hotblade verify: measures a program against its design again.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/cli/backend_option.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/ends_on_signal.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/plan/arms/check_joints.hpp"
#include "pipeline/program/design_file.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/report/json/verify_json.hpp"
#include "pipeline/verify/as_cut.hpp"
#include "pipeline/verify/largest_text.hpp"
#include "pipeline/verify/verify.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;

struct VerifyArguments {
  std::string program, design, as_cut, cell, backend = "auto";
  bool json = false;
  double sample_mm = 2.5;
  int jobs = 0;  // all cores
};

fs::path find_design(const VerifyArguments& arguments, const Program& program) {
  return given_or_at_hand(arguments.design, arguments.program, program);
}

// One line a strip: the branch of shapes found from its clamp poses.
void print_branches(const Program& program, const VerifyReport& report) {
  for (std::size_t i = 0; i < report.branches.size(); ++i) {
    const BranchReport& b = report.branches[i];
    const Strip& strip = program.strips[i];
    if (b.held()) {
      std::cout << fmt::format(
          "{}  blade held on one branch: within {:.4f} mm of the plan by clamps in whole micrometres, "
          "margin at least {:.1f}, radius at least {:.0f} mm{}\n",
          strip.id, b.mismatch_mm, b.smallest_margin, 1 / std::max(b.largest_curvature_per_mm, 1e-9),
          b.taut_poses > 0 ? fmt::format(", {} waypoints straight", b.taut_poses) : "");
    } else {
      std::cout << describe(branch_refusal(strip, b)) << "\n";
    }
  }
}

// What the program says of its ribs, measured again.
void print_ribs(const RibCheck& check) {
  constexpr std::size_t kMostLines = 10;
  std::cout << describe_beziers(check) << "\n";
  for (std::size_t i = 0; i < std::min(kMostLines, check.far.size()); ++i)
    std::cout << describe(check.far[i]) << "\n";
  if (check.mismatches.empty()) {
    std::cout << fmt::format(
        "ribs {}: L2, H1, Hausdorff distance and lambda-residual measured again, as the program says\n",
        check.ribs);
    return;
  }
  for (std::size_t i = 0; i < std::min(kMostLines, check.mismatches.size()); ++i)
    std::cout << describe(check.mismatches[i]) << "\n";
  std::cout << fmt::format("ribs {}: {} numbers are not what was measured\n", check.ribs,
                           check.mismatches.size());
}

// What the motion asks of machine, heat and block.
void print_motion(const std::vector<MotionBreach>& breaches) {
  for (const MotionBreach& breach : breaches) std::cout << breach.text << "\n";
  if (breaches.empty())
    std::cout << "motion: within the machine's limits, hot in foam, all foam in its block\n";
}

// A cut within tolerance is not enough when the plan was refused for another limit.
Exit expect_passed(const Program& program, const Console& console) {
  if (program.verification.status == VerificationStatus::kPassed) return Exit::kOk;
  console.warn(std::string("the plan's status is ") + name(program.verification.status) + ": not to be run");
  for (const std::string& line : program.overrides) console.warn("overridden: " + line);
  return Exit::kNotCuttable;
}

// What was measured, against the program's limits.
Exit judged(const VerifyReport& report, const std::optional<JointCheck>& joints) {
  if (joints && !joints->breaches.empty()) return Exit::kDeviation;
  if (!report.within_tolerance || !report.ribs.mismatches.empty() || !report.ribs.far.empty())
    return Exit::kDeviation;
  return report.holds() && report.motion.empty() ? Exit::kOk : Exit::kNotCuttable;
}

// The colour that the program's own status and budget amount to, where what was measured leaves them
// standing.
void print_verdict(const Program& program, bool stands) {
  if (!stands) {
    std::cout << "verdict " << painted(name(VerdictColor::kRed), Paint::kBad, STDOUT_FILENO)
              << ": measured now, the program does not hold: it says " << name(program.verification.status)
              << "\n";
    return;
  }
  const Verdict verdict = verdict_of(program);
  std::cout << budget_text(verdict) << "\n";
  std::cout << "verdict of the plan " << painted(name(verdict.color), paint_of(verdict.color), STDOUT_FILENO)
            << ": " << headline(verdict) << "\n";
}

VerifyOptions options_of(const VerifyArguments& arguments, const Program& program) {
  VerifyOptions options;
  options.tolerance_mm = program.verification.tolerance_mm;
  options.max_uncut_share = program.settings.design.max_uncut_share;
  options.min_margin = program.settings.blade.min_margin;
  options.sample_mm = arguments.sample_mm;
  options.backend = backend_named(arguments.backend);
  return options;
}

// What an execution log says was cut.
Exit verify_as_cut(const VerifyArguments& arguments, const Console& console) {
  const StripJobs work = read_strip_jobs(arguments.program, true);
  const surface::DesignSurface design = read_design_of(work.program, find_design(arguments, work.program));
  console.report_progress("read", 0.2);
  const auto executed = read_executed(work, arguments.as_cut);
  console.report_progress("verify", 0.5);
  const VerifyOptions options = options_of(arguments, work.program);
  const AsCutReport report = as_cut(work.program, executed, design, options);
  console.report_progress("done", 1);
  tell_backend(report.cut, options.backend, console);
  std::cout << (arguments.json ? to_json(report, options) + "\n" : describe(report, options));
  if (!arguments.json) std::cout << (report.cut.within_tolerance ? "within tolerance\n" : "over tolerance\n");
  return report.cut.within_tolerance ? Exit::kOk : Exit::kDeviation;
}

void print_report(const Program& program, const VerifyReport& report, const VerifyOptions& options) {
  const Deviation& d = report.deviation;
  for (std::size_t i = 0; i < program.strips.size(); ++i) {
    std::cout << fmt::format("{}  deviation max {:.3f} mm\n", program.strips[i].id, report.strip_max_mm[i]);
  }
  std::cout << fmt::format("samples {} of the cut, {} of the design\n", report.cut_samples,
                           report.design_samples);
  std::cout << fmt::format(
      "deviation max {}, p99 {:.3f} mm, rms {:.3f} mm, mean {:.3f} mm (tolerance {:.3g} mm), worst at "
      "({:.1f}, {:.1f}, {:.1f})\n",
      largest_and_bound_text(report), d.p99, d.rms, d.mean, options.tolerance_mm, d.at.x(), d.at.y(),
      d.at.z());
  std::cout << fmt::format("uncut {:.0f} mm2 ({:.2f} % of the design, limit {:.2f} %)\n", report.uncut_mm2,
                           100 * report.uncut_share(), 100 * options.max_uncut_share);
  print_branches(program, report);
  print_ribs(report.ribs);
  print_motion(report.motion);
  for (const std::string& item : program.verification.not_checked)
    std::cout << "not checked: " << item << "\n";
  if (report.clamp_mismatch_mm > kClampMismatchMm) {
    std::cout << fmt::format("clamps are {:.3f} mm off the planned blade's ends (limit {} mm)\n",
                             report.clamp_mismatch_mm, kClampMismatchMm);
  }
  std::cout << (report.within_tolerance ? "within tolerance\n" : "over tolerance\n");
}

void print_joints(const JointCheck& check) {
  std::cout << fmt::format(
      "joints: jaws within {:.2g} mm and {:.2g} rad of their clamps, limits {:.1f} degrees away, wrists "
      "{:.1f} degrees from "
      "straight, speeds up to {:.0f} %, accelerations up to {:.0f} %, jerk up to {:.0f} % of the cell's\n",
      check.off_mm, check.off_rad, check.joint_margin_rad / robot::kDegree_rad,
      check.wrist_rad / robot::kDegree_rad, 100 * check.speed_share, 100 * check.acceleration_share,
      100 * check.jerk_share);
  for (const std::string& line : check.nearest) std::cout << "nearest: " << line << "\n";
  for (const std::string& line : check.breaches) std::cout << line << "\n";
}

Exit verify_program(const VerifyArguments& arguments, const Console& console) {
  const int threads = arguments.jobs > 0 ? arguments.jobs : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  const EndsOnSignal ends(console, "interrupted: not measured to the end");
  if (!arguments.as_cut.empty()) return verify_as_cut(arguments, console);
  Program program = read_program(arguments.program);
  std::optional<JointCheck> joints;
  if (!arguments.cell.empty()) {
    const robot::Cell cell = read_cell(arguments.cell);
    joints = check_joints(program, cell);
    tell_not_looked_at(program, cell);
  }
  const fs::path design_file = find_design(arguments, program);
  console.report_progress("read", 0.1);
  const surface::DesignSurface design = read_design_of(program, design_file);
  const VerifyOptions options = options_of(arguments, program);
  console.report_progress("verify", 0.3);
  const VerifyReport report = verify(program, design, options);
  console.report_progress("done", 1);
  tell_backend(report, options.backend, console);
  const Exit code = judged(report, joints);
  if (arguments.json) {
    std::cout << verify_json(program, report, options, joints ? to_json(*joints) : nlohmann::ordered_json());
  } else {
    print_report(program, report, options);
    if (joints) print_joints(*joints);
    print_verdict(program, code == Exit::kOk);
  }
  const Exit planned = expect_passed(program, console);
  return code == Exit::kOk ? planned : code;
}

}  // namespace

void add_verify(CLI::App& app, const Console& console, Action& action) {
  auto arguments = std::make_shared<VerifyArguments>();
  auto* command =
      app.add_subcommand("verify", "Measure a program's cut surface against its design, both ways");
  command->add_option("program", arguments->program, "program.json")->required()->type_name("PROGRAM");
  command
      ->add_option("--design", arguments->design,
                   "The design's file (default: beside the program, or as planned)")
      ->type_name("FILE");
  command
      ->add_option("--as-cut", arguments->as_cut,
                   "Measure what this execution log says was cut, instead of the plan")
      ->type_name("JSONL");
  command
      ->add_option("--cell", arguments->cell, "Measure the joints too, by the cell that they were found for")
      ->type_name("CELL");
  command->add_flag("--json", arguments->json, "The result as one JSON object");
  add_backend_option(*command, arguments->backend);
  command
      ->add_option("--sample", arguments->sample_mm,
                   "Spacing of the samples on both surfaces where they lie close, mm")
      ->check(CLI::Range(0.05, 100.0))
      ->type_name("MM");
  command->add_option("--jobs", arguments->jobs, "Threads (default: all cores)")
      ->check(CLI::Range(1, kMostThreads));
  command->footer(
      "Exit code 5 when the deviation or the uncut area is over the program's limits, a rib's measures are "
      "not "
      "those that the program states, or its Beziers lie farther from its elastica than a tenth of the "
      "tolerance, 4 when the blade would "
      "snap, yield or leave the planned shapes, the motion does not hold, or the plan was "
      "refused, 3 when the log of --as-cut is another program's, incomplete or without shapes.\n"
      "Example: hotblade verify vault_cut/program.json --design vault.obj");
  command->callback([arguments, &console, &action] {
    action = [arguments, &console] { return verify_program(*arguments, console); };
  });
}

}  // namespace hotblade::pipeline
