// hotblade.plan and hotblade.verify.
#include "pipeline/plan/plan.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pipeline/program/sha256.hpp"
#include "pipeline/report/json/report_json.hpp"
#include "pipeline/report/json/verify_json.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/verify/verify.hpp"
#include "python/module.hpp"
#include "surface/read/self_crossings.hpp"

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

// How a design was read belongs to its program, whose reader reads it again: settings may leave it out, and
// may not say something else.
Settings settings_for(const Design& design, Settings settings) {
  const DesignSettings unsaid;
  const auto take = [&](auto DesignSettings::*member, const char* key) {
    auto& said = settings.design.*member;
    const auto& read = design.settings.*member;
    if (said != unsaid.*member && said != read)
      throw Error(ErrorKind::kBadSettings,
                  fmt::format("design.{}: the settings say something else than {} was read by: read it with "
                              "settings=",
                              key, design.surface.file_name));
    said = read;
  };
  take(&DesignSettings::units, "units");
  take(&DesignSettings::up, "up");
  take(&DesignSettings::format, "format");
  take(&DesignSettings::group, "group");
  take(&DesignSettings::facing, "facing");
  take(&DesignSettings::facing_max_deg, "facing_max_deg");
  take(&DesignSettings::stitch_mm, "stitch_mm");
  return settings;
}

void expect_sliceable(const surface::DesignSurface& design) {
  if (design.health.blockers.empty()) return;
  throw Error(ErrorKind::kBadInput,
              design.file_name + ": cannot be sliced: " + design.health.blockers.front());
}

std::shared_ptr<Plan> plan(const Design& design, const std::shared_ptr<Settings>& given, int threads,
                           const py::object& progress) {
  const Settings settings = settings_for(design, given ? *given : Settings{});
  expect_sliceable(design.surface);
  auto result = std::make_shared<Plan>();
  run_watched(threads, progress, [&](const Tell& tell) {
    pipeline::PlanHooks hooks;
    hooks.progress = tell;
    pipeline::PlanResult found = pipeline::plan(design.surface, settings, hooks);
    // What the design has to be told of too, as `hotblade plan` does.
    for (const std::string& line : design.surface.health.warnings) found.warnings.push_back(line);
    if (std::string text = surface::self_crossings_text(design.surface); !text.empty())
      found.warnings.push_back(std::move(text));
    result->facts = std::make_shared<const pipeline::PlanResult>(std::move(found));
    result->program = std::make_shared<Program>(
        std::shared_ptr<const pipeline::Program>(result->facts, &result->facts->program));
  });
  return result;
}

// report.json; it names the program by the text that save() writes.
py::object report(Plan& plan) {
  if (!plan.report.is_none()) return plan.report;
  const std::shared_ptr<const pipeline::PlanResult> facts = plan.facts;
  const bool passed = facts->program.verification.status == pipeline::VerificationStatus::kPassed;
  std::string text;
  {
    const py::gil_scoped_release release;
    text = report_json(*facts, passed ? pipeline::sha256_hex(to_json(facts->program)) : "");
  }
  plan.report = parsed(text);
  return plan.report;
}

py::list refusals(const Plan& plan) {
  py::list list;
  for (const pipeline::Refusal& refusal : plan.facts->refusals) list.append(to_python(to_json(refusal)));
  return list;
}

py::list lines(const std::vector<std::string>& texts) {
  py::list list;
  for (const std::string& text : texts) list.append(text);
  return list;
}

void check_plan(const Plan& plan) {
  if (plan.facts->refusals.empty()) return;
  throw Error(ErrorKind::kNotCuttable, describe(plan.facts->refusals.front()));
}

struct Check {
  std::string json;
  bool within_tolerance = false, ribs_hold = false, held = false, passed = false;
  double deviation_mm = 0, tolerance_mm = 0;
};

std::shared_ptr<Check> verify(const Program& program, const Design& design, double sample_mm, int threads,
                              const py::object& progress) {
  const pipeline::Program& data = *program.data;
  if (design.surface.sha256 != data.design.sha256)
    throw Error(
        ErrorKind::kBadInput,
        fmt::format("{}: not the design of this program (sha256 {}, limit {})", design.surface.file_name,
                    design.surface.sha256.substr(0, 12), data.design.sha256.substr(0, 12)));
  if (!(sample_mm >= 0.05 && sample_mm <= 100))
    throw Error(ErrorKind::kBadSettings, fmt::format("sample_mm ({}, limits 0.05 and 100)", sample_mm));
  pipeline::VerifyOptions options;
  options.tolerance_mm = data.verification.tolerance_mm;
  options.max_uncut_share = data.settings.design.max_uncut_share;
  options.min_margin = data.settings.blade.min_margin;
  options.sample_mm = sample_mm;
  auto check = std::make_shared<Check>();
  run_watched(threads, progress, [&](const Tell& tell) {
    tell("verify", 0);
    const pipeline::VerifyReport report = pipeline::verify(data, design.surface, options);
    check->json = verify_json(data, report, options, {});
    check->within_tolerance = report.within_tolerance;
    check->ribs_hold = report.ribs.mismatches.empty() && report.ribs.far.empty();
    check->held = report.holds();
    check->passed = data.verification.status == pipeline::VerificationStatus::kPassed;
    check->deviation_mm = report.deviation.max;
    check->tolerance_mm = options.tolerance_mm;
  });
  return check;
}

// In the order of the exit codes of `hotblade verify`.
void check_cut(const Check& check) {
  if (!check.within_tolerance)
    throw Error(ErrorKind::kDeviation, fmt::format("over tolerance: deviation {:.3f} mm (limit {:g} mm)",
                                                   check.deviation_mm, check.tolerance_mm));
  if (!check.ribs_hold)
    throw Error(ErrorKind::kDeviation, "ribs: measured again they are not as the program says");
  if (!check.held) throw Error(ErrorKind::kNotCuttable, "the clamps do not hold the blade in its shapes");
  if (!check.passed) throw Error(ErrorKind::kNotCuttable, "the plan's status is refused: not to be run");
}

}  // namespace

void add_plan(py::module_& module) {
  py::class_<Plan, std::shared_ptr<Plan>>(module, "Plan", "What came of a plan.")
      .def_property_readonly("status",
                             [](const Plan& plan) { return name(plan.program->data->verification.status); })
      .def_property_readonly("refusals", &refusals)
      .def_property_readonly("warnings", [](const Plan& plan) { return lines(plan.facts->warnings); })
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
      .def_readonly("held", &Check::held)
      .def_readonly("deviation_mm", &Check::deviation_mm)
      .def_readonly("tolerance_mm", &Check::tolerance_mm)
      .def("check", &check_cut, "Raises OverTolerance or NotCuttable where the program is not to be run.")
      .def("__repr__", [](const Check& check) {
        return fmt::format("<hotblade.Check {}: {:.3f} mm>",
                           check.within_tolerance ? "within tolerance" : "over tolerance",
                           check.deviation_mm);
      });
  module.def("plan", &plan, py::arg("design"), py::arg("settings") = nullptr, py::arg("threads") = 0,
             py::arg("progress") = py::none(), "Plans and verifies the cut program of a design.");
  module.def("verify", &verify, py::arg("program"), py::arg("design"), py::arg("sample_mm") = 2.5,
             py::arg("threads") = 0, py::arg("progress") = py::none(),
             "Measures a program against its design again.");
}

}  // namespace hotblade::python
