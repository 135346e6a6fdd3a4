// hotblade.plan and hotblade.verify.
#include "pipeline/plan/plan.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "gpu/backend/stop.hpp"
#include "pipeline/advice/advice.hpp"
#include "pipeline/advice/design_trials.hpp"
#include "pipeline/plan/arms/check_joints.hpp"
#include "pipeline/program/read_design.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/report/json/report_json.hpp"
#include "pipeline/report/json/verify_json.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_bytes.hpp"
#include "pipeline/verify/largest_text.hpp"
#include "pipeline/verify/verify.hpp"
#include "python/module.hpp"
#include "surface/read/self_crossings.hpp"
#include "surface/slice/plane_family.hpp"

namespace hotblade::python {
namespace {

using pipeline::DesignSettings;
using pipeline::Error;
using pipeline::ErrorKind;
using pipeline::Settings;

struct Plan {
  std::shared_ptr<const pipeline::PlanResult> facts;
  std::shared_ptr<Program> program;  // that of `facts`
  py::object report = py::none();
};

// How the design was read, its format said.
DesignSettings read_by(const Design& design) {
  DesignSettings settings = design.settings;
  settings.format = surface::name(design.surface.format);
  return settings;
}

// How a design was read belongs to its program, whose reader reads it again: settings may leave it out, and
// may not say something else.
Settings settings_for(const Design& design, const pipeline::SaidSettings& given) {
  DesignSettings said = given.settings.design;
  const std::string gltf(surface::name(surface::FileFormat::kGltf));
  if (design.surface.format == surface::FileFormat::kGltf &&
      (said.format == DesignSettings().format || said.format == gltf)) {
    said.format = gltf;
    pipeline::take_format(design.surface.file_name, false, said);
  }
  if (const auto otherwise = read_otherwise(said, read_by(design), given.said))
    throw Error(
        ErrorKind::kBadSettings,
        fmt::format("design.{}: the settings say something else ({}) than {} was read by ({}): read it with "
                    "settings=",
                    otherwise->key, otherwise->one, design.surface.file_name, otherwise->other));
  Settings settings = given.settings;
  const auto take = [&](auto DesignSettings::*member) { settings.design.*member = design.settings.*member; };
  take(&DesignSettings::units);
  take(&DesignSettings::up);
  take(&DesignSettings::format);
  take(&DesignSettings::group);
  take(&DesignSettings::facing);
  take(&DesignSettings::facing_max_deg);
  take(&DesignSettings::stitch_mm);
  return settings;
}

// Throws Error unless a design is that of a program, read as its plan read it.
void expect_design_of(const pipeline::Program& program, const Design& design) {
  if (design.surface.sha256 != program.design.sha256)
    throw Error(
        ErrorKind::kBadInput,
        fmt::format("{}: not the design of this program (sha256 {}, limit {})", design.surface.file_name,
                    design.surface.sha256.substr(0, 12), program.design.sha256.substr(0, 12)));
  const DesignSettings planned = read_by(program);
  if (const auto otherwise = read_otherwise(read_by(design), planned, all_said({}).said))
    throw Error(
        ErrorKind::kBadSettings,
        fmt::format("design: {} was read with design.{} = {}, and for this program with {}: read it with "
                    "settings=program.settings",
                    design.surface.file_name, otherwise->key, otherwise->one, otherwise->other));
}

// Which settings a refused plan is tried again with.
enum class Tried { kNone, kShape, kAll };

Tried tried_of(const std::string& word) {
  if (word == "none") return Tried::kNone;
  if (word == "shape") return Tried::kShape;
  if (word == "all") return Tried::kAll;
  throw Error(ErrorKind::kBadSettings,
              fmt::format("remedies (\"{}\", must be one of none, shape, all)", word));
}

// The design read again as other settings say. Throws Error (kBadInput) where its file is not as it was.
surface::DesignSurface read_again(const Design& design, const DesignSettings& how) {
  if (!design.obj.empty())
    return surface::surface_of(design.obj, design.surface.file_name, pipeline::read_options(how));
  surface::DesignSurface again = pipeline::read_design(design.file, how);
  if (again.sha256 != design.surface.sha256)
    throw Error(ErrorKind::kBadInput, design.file.string() + ": changed since it was read");
  return again;
}

// Plans as `hotblade plan` does, but for its files.
class Planner {
 public:
  Planner(const Design& design, const Settings& settings, std::shared_ptr<const robot::Cell> cell,
          Tried tried)
      : design_(design), settings_(settings), cell_(std::move(cell)), tried_(tried) {}

  pipeline::PlanResult plan(const Tell& tell) const {
    std::vector<std::string> warnings = design_.surface.health.warnings;
    const std::vector<pipeline::Suggestion> suggested = suggestions(warnings);
    const bool may_try = tried_ == Tried::kAll || (tried_ == Tried::kShape && !suggested.empty());
    const double planned = may_try ? 0.5 : 1;
    const double posed = cell_ ? planned / 2 : planned;
    pipeline::PlanResult result = pipeline::plan(design_.surface, settings_, hooks(tell, 0, posed));
    if (cell_) {
      tell("arms", posed);
      hold_in_cell(design_.surface, *cell_, gpu::Backend::kCpu, result);
    }
    if (std::string text = surface::self_crossings_text(design_.surface, gpu::stop_point); !text.empty())
      warnings.push_back(std::move(text));
    result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
    if (may_try && !result.refusals.empty()) try_remedies(suggested, tell, planned, result);
    return result;
  }

 private:
  static pipeline::PlanHooks hooks(const Tell& tell, double from, double to) {
    pipeline::PlanHooks hooks;
    hooks.progress = [&tell, from, to](const std::string& stage, double share) {
      tell(stage, from + share * (to - from));
    };
    return hooks;
  }

  // What the design's shape suggests, and what it warns of.
  std::vector<pipeline::Suggestion> suggestions(std::vector<std::string>& warnings) const {
    if (!(design_.surface.health.area_mm2 > 0)) return {};
    try {
      pipeline::FirstLook look = first_look(design_.surface, settings_);
      if (const auto warning = warning_of(look.odd_size)) warnings.push_back(*warning);
      if (look.planes_warning) warnings.push_back(*look.planes_warning);
      return std::move(look.suggestions);
    } catch (const surface::FanError&) {  // of which the plan tells
      return {};
    }
  }

  void try_remedies(const std::vector<pipeline::Suggestion>& suggested, const Tell& tell, double from,
                    pipeline::PlanResult& result) const {
    const auto changes =
        tried_ == Tried::kAll ? likely_changes(result, suggested) : changes_by_shape(suggested);
    std::string lost;  // why the design cannot be read again
    const auto read = [&](const DesignSettings& how) {
      try {
        return read_again(design_, how);
      } catch (const surface::FileError& error) {
        lost = error.what();
        throw Error(ErrorKind::kFile, lost);
      } catch (const Error& error) {
        lost = error.what();
        throw;
      }
    };
    const auto judge = [&](const surface::DesignSurface& same, pipeline::PlanResult& again) {
      if (cell_) hold_in_cell(same, *cell_, gpu::Backend::kCpu, again);
    };
    int trial = 0;
    const double each = (1 - from) / pipeline::kMostPlans;
    result.remedies = try_changes(settings_, changes, [&](const Settings& changed) {
      const double begun = from + each * trial++;
      return plan_again(read, changed, hooks(tell, begun, begun + each), false, judge);
    });
    if (!lost.empty()) result.warnings.push_back("no remedies were tried: " + lost);
  }

  const Design& design_;
  const Settings& settings_;
  std::shared_ptr<const robot::Cell> cell_;
  Tried tried_;
};

const Design& design_of(const py::object& given) {
  return instance<Design>(
      given, "design", "hotblade.Design",
      "hotblade.read() makes one of a file, Design.from_arrays() of points and triangles");
}

// Runs what may throw an error of the design that begins with its name.
template <typename Work>
void of_design_file(const Design& design, const Work& work) {
  placed(work, [&](const std::string& what) {
    throw_placed(what, design.surface.file_name, design.file.string());
  });
}

std::shared_ptr<Plan> plan(const py::object& planned, const py::object& given, const py::object& threads,
                           const py::object& progress, const py::object& cell, const py::object& remedies) {
  const Design& design = design_of(planned);
  const Settings settings = settings_for(design, settings_of(given));
  const Planner planner(design, settings, cell_of(cell), tried_of(text(remedies, "remedies")));
  of_design_file(design, [&] { pipeline::refuse_blocked(design.surface, design.surface.file_name); });
  auto result = std::make_shared<Plan>();
  run_watched(threads, progress, [&](const Tell& tell) {
    result->facts = std::make_shared<pipeline::PlanResult>(planner.plan(tell));
    result->program = std::make_shared<Program>(
        Program{std::shared_ptr<const pipeline::Program>(result->facts, &result->facts->program)});
  });
  return result;
}

// report.json; it names the program by the text that save() writes.
py::object report(Plan& plan) {
  if (!plan.report.is_none()) return plan.report;
  const std::shared_ptr<const pipeline::PlanResult> facts = plan.facts;
  const bool passed = facts->program.verification.status == pipeline::VerificationStatus::kPassed;
  const nlohmann::ordered_json json = unlocked([&] {
    return pipeline::whole_json<nlohmann::ordered_json>(
        report_json(*facts, passed ? pipeline::sha256_hex(to_json(facts->program)) : ""));
  });
  plan.report = to_python(json);
  return plan.report;
}

py::list refusals(const Plan& plan) {
  py::list list;
  for (const pipeline::Refusal& refusal : plan.facts->refusals) list.append(to_python(to_json(refusal)));
  return list;
}

py::object remedies(const Plan& plan) {
  return to_python(to_json(plan.facts->remedies));
}

void check_plan(const Plan& plan) {
  if (plan.facts->refusals.empty()) return;
  throw Error(ErrorKind::kNotCuttable, describe(plan.facts->refusals.front()));
}

struct Check {
  std::string json, over, motion;  // of the motion the first that does not hold; empty: all does
  bool within_tolerance = false, joints_hold = true, ribs_hold = false, held = false, passed = false;
  double deviation_mm = 0, tolerance_mm = 0;
};

std::shared_ptr<Check> verify(const py::object& program, const py::object& read_design,
                              const py::object& sample, const py::object& threads, const py::object& progress,
                              const py::object& cell) {
  const pipeline::Program& data = *instance<Program>(program, "program", "hotblade.Program",
                                                     "a plan's .program, or Program.load() of a file")
                                       .data;
  const Design& design = design_of(read_design);
  of_design_file(design, [&] { expect_design_of(data, design); });
  const double sample_mm = number(sample, "sample_mm");
  if (!(sample_mm >= 0.05 && sample_mm <= 100))
    throw Error(ErrorKind::kBadSettings, fmt::format("sample_mm ({}, limits 0.05 and 100)", sample_mm));
  pipeline::VerifyOptions options;
  options.tolerance_mm = data.verification.tolerance_mm;
  options.max_uncut_share = data.settings.design.max_uncut_share;
  options.min_margin = data.settings.blade.min_margin;
  options.sample_mm = sample_mm;
  const std::shared_ptr<const robot::Cell> arms = cell_of(cell);
  auto check = std::make_shared<Check>();
  run_watched(threads, progress, [&](const Tell& tell) {
    tell("verify", 0);
    nlohmann::ordered_json joints;
    if (arms) {
      const pipeline::JointCheck measured = check_joints(data, *arms);
      check->joints_hold = measured.breaches.empty();
      joints = to_json(measured);
    }
    const pipeline::VerifyReport report = pipeline::verify(data, design.surface, options);
    check->json = verify_json(data, report, options, joints);
    check->within_tolerance = report.within_tolerance;
    check->over = over_text(report, options);
    check->ribs_hold = report.ribs.mismatches.empty() && report.ribs.far.empty();
    check->held = report.holds();
    if (!report.motion.empty()) check->motion = report.motion.front().text;
    check->passed = data.verification.status == pipeline::VerificationStatus::kPassed;
    check->deviation_mm = report.deviation.max;
    check->tolerance_mm = options.tolerance_mm;
  });
  return check;
}

// In the order of the exit codes of `hotblade verify`.
void check_cut(const Check& check) {
  if (!check.joints_hold)
    throw Error(ErrorKind::kDeviation, "joints: measured again they do not hold what the cell allows");
  if (!check.within_tolerance) throw Error(ErrorKind::kDeviation, "over tolerance: " + check.over);
  if (!check.ribs_hold)
    throw Error(ErrorKind::kDeviation, "ribs: measured again they are not as the program says");
  if (!check.held) throw Error(ErrorKind::kNotCuttable, "the clamps do not hold the blade in its shapes");
  if (!check.motion.empty()) throw Error(ErrorKind::kNotCuttable, check.motion);
  if (!check.passed) throw Error(ErrorKind::kNotCuttable, "the plan's status is refused: not to be run");
}

}  // namespace

void add_plan(py::module_& module) {
  py::class_<Plan, std::shared_ptr<Plan>>(module, "Plan", "What came of a plan.")
      .def_property_readonly("status",
                             [](const Plan& plan) { return name(plan.program->data->verification.status); })
      .def_property_readonly("refusals", &refusals)
      .def_property_readonly("warnings",
                             [](const Plan& plan) { return py::list(texts(plan.facts->warnings)); })
      .def_property_readonly("remedies", &remedies)
      .def_property_readonly("report", &report)
      .def_property_readonly("program", [](const Plan& plan) { return plan.program; })
      .def("check", &check_plan, "Raises NotCuttable, with the first reason, where the plan was refused.")
      .def("__repr__", [](const Plan& plan) {
        return fmt::format("<hotblade.Plan {}: {} strips>", name(plan.program->data->verification.status),
                           plan.program->data->strips.size());
      });
  py::class_<Check, std::shared_ptr<Check>>(module, "Check", "What was measured of a program again.")
      .def_property_readonly("report", [](const Check& check) { return parsed(check.json); })
      .def_readonly("within_tolerance", &Check::within_tolerance)
      .def_readonly("joints_hold", &Check::joints_hold)
      .def_readonly("held", &Check::held)
      .def_readonly("deviation_mm", &Check::deviation_mm)
      .def_readonly("tolerance_mm", &Check::tolerance_mm)
      .def("check", &check_cut, "Raises OverTolerance or NotCuttable where the program is not to be run.")
      .def("__repr__", [](const Check& check) {
        return fmt::format("<hotblade.Check {}: {:.3f} mm>",
                           check.within_tolerance ? "within tolerance" : "over tolerance",
                           check.deviation_mm);
      });
  module.def("plan", &plan);
  module.def("verify", &verify);
}

}  // namespace hotblade::python
