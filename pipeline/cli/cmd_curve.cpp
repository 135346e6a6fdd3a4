// hotblade curve: curve tools for other programs, JSON lines in, JSON lines out.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "elastica/bezier/curve_distance.hpp"
#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/blade/equilibria.hpp"
#include "elastica/fit/even_points.hpp"
#include "elastica/fit/fit.hpp"
#include "elastica/fit/fit_bezier.hpp"
#include "elastica/fit/fit_clamped.hpp"
#include "elastica/projection/project.hpp"
#include "elastica/projection/project_zone.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/curve_lines.hpp"

namespace hotblade::pipeline {
namespace {

using namespace curve_lines;
using curve_lines::to_json;
using elastica::Bezier;
using elastica::Elastica;

Bezier bezier(const Json& line) {
  return cubic(field(line, "bezier"), "bezier");
}

Json residual(const Json& line) {
  const elastica::LambdaResidual r = elastica::lambda_residual(bezier(line));
  if (r.status == elastica::ResidualStatus::kNotFinite) throw LineError("bezier: coordinates beyond 1e140");
  Json answer;
  if (has_value(r.status)) {
    answer = {{"lambda_residual", r.value},
              {"lambda1", r.lambda1},
              {"lambda2", r.lambda2},
              {"alpha", r.alpha},
              {"bound", r.bound}};
  } else {
    for (const char* key : {"lambda_residual", "lambda1", "lambda2", "alpha", "bound"}) answer[key] = nullptr;
  }
  answer["status"] = name(r.status);
  return answer;
}

struct ProjectArguments {
  std::string method = "feedback", branch = "best";
  double threshold = 0;
};

Json project(const Json& line, const ProjectArguments& arguments) {
  using elastica::WantedBranch;
  const Bezier b = bezier(line);
  const WantedBranch wanted = arguments.branch == "inflectional" ? WantedBranch::kInflectional
                              : arguments.branch == "plain"      ? WantedBranch::kPlain
                                                                 : WantedBranch::kBest;
  const bool optimal = arguments.method == "optimal";
  const elastica::Projection p =
      optimal && arguments.threshold > 0 ? elastica::project_smallest_move(b, wanted, arguments.threshold)
      : optimal                          ? elastica::project_optimal(b, wanted)
      : arguments.method == "zone"       ? elastica::project_zone(b, arguments.threshold)
                                         : elastica::project_feedback(b, arguments.threshold);
  if (p.status == elastica::ProjectStatus::kUnsupported) {
    throw LineError("bezier: its ends coincide, an end edge is zero, or the branch has no curve");
  }
  return {{"bezier", to_json(p.bezier)},
          {"lambda_residual", p.lambda_residual},
          {"branch", name(p.branch)},
          {"moved", {p.moved[0], p.moved[1]}},
          {"angle_constraints_hold", p.angle_constraints_hold},
          {"status", name(p.status)}};
}

std::vector<Eigen::Vector2d> fit_points(const Json& line) {
  const auto given = points(field(line, "points"), "points");
  if (given.size() < elastica::kFewestFitPoints)
    throw LineError(
        fmt::format("points: {} given (at least {} needed)", given.size(), elastica::kFewestFitPoints));
  std::vector<Eigen::Vector2d> even = elastica::even_points(given);
  if (even.empty()) throw LineError("points: all the same");
  return even;
}

Json fit_free(const Json& line) {
  if (line.is_object() && line.contains("bezier")) {
    const Bezier b = bezier(line);
    const elastica::BezierElasticaFit f = elastica::fit_bezier_elastica(b);
    if (f.status == elastica::FitStatus::kUnsupported) {
      throw LineError("bezier: has a cusp or an end edge of length zero, or winds beyond any blade");
    }
    const elastica::CurveDistance d = distance(b, f.elastica);
    return {{"elastica", to_json(f.elastica)},
            {"l2", d.l2},
            {"h1", d.h1},
            {"hausdorff", d.hausdorff},
            {"hausdorff_error", d.hausdorff_error},
            {"starts_tried", f.starts_tried},
            {"status", name(f.status)}};
  }
  const elastica::ElasticaFit f = elastica::fit_elastica(fit_points(line), {}, {0, nullptr, 0});
  return {{"elastica", to_json(f.elastica)},
          {"l2", f.rms / f.elastica.length},
          {"h1", nullptr},  // points have no tangents
          {"hausdorff", f.max},
          {"starts_tried", f.starts_tried},
          {"status", f.converged ? "ok" : "not_converged"}};
}

Json fit_clamped(const Json& line) {
  elastica::ClampedFit f;
  Json answer;
  if (line.is_object() && line.contains("bezier")) {
    const Bezier b = bezier(line);
    f = elastica::fit_clamped(b);
    if (f.starts_tried == 0) throw LineError("bezier: has an end edge of length zero");
    const elastica::CurveDistance d = distance(b, f.elastica);
    answer = {{"elastica", to_json(f.elastica)}, {"l2", d.l2}, {"h1", d.h1}, {"hausdorff", d.hausdorff}};
    answer["hausdorff_error"] = d.hausdorff_error;
  } else {
    const auto q = fit_points(line);
    const Json& tangents = field(line, "tangents");
    if (!tangents.is_array() || tangents.size() != 2) throw LineError("tangents: two angles needed");
    const double first = number(tangents[0], "tangents[0]"), last = number(tangents[1], "tangents[1]");
    const double turning = elastica::true_turning(q, first, last);
    const elastica::PlanarPose end{q.back().x(), q.back().y(), first + turning};
    f = elastica::fit_clamped(q, {{q.front().x(), q.front().y(), first}, end}, {}, {0, nullptr, 0});
    answer = {{"elastica", to_json(f.elastica)}, {"l2", f.rms / f.elastica.length}, {"h1", nullptr}};
    answer["hausdorff"] = f.max;
  }
  answer["starts_tried"] = f.starts_tried;
  answer["status"] = name(f.status);
  return answer;
}

Json sample(const Json& line) {
  const Elastica e = elastica_of(line);
  const double n = number(field(line, "n"), "n");
  if (!(n >= 2 && n <= static_cast<double>(kMostPoints)) || n != std::floor(n)) {
    throw LineError(fmt::format("n: out of range ({}, 2 to {})", n, kMostPoints));
  }
  Json answer{{"points", Json::array()}, {"theta", Json::array()}, {"kappa", Json::array()}};
  for (const elastica::CurvePoint& p : elastica::sample(e, static_cast<int>(n))) {
    answer["points"].push_back({p.x, p.y});
    answer["theta"].push_back(p.theta);
    answer["kappa"].push_back(p.kappa);
  }
  return answer;
}

elastica::PlanarPose clamp_pose(const Json& line, const char* name) {
  const Json& value = field(line, name);
  if (!value.is_array() || value.size() != 3)
    throw LineError(fmt::format("{}: a clamp is [x, y, theta]", name));
  return {number(value[0], fmt::format("{}[0]", name)), number(value[1], fmt::format("{}[1]", name)),
          number(value[2], fmt::format("{}[2]", name))};
}

Json equilibria(const Json& line) {
  const elastica::ClampPair clamps{clamp_pose(line, "a"), clamp_pose(line, "b")};
  const double length = number(field(line, "length"), "length");
  if (!(length > 0)) throw LineError("length: must be positive");
  // Turns beyond this wind tighter than any blade, and the far clamp's turning is the true one.
  constexpr double kMostTurning = 100;
  const double turning = clamps.b.theta - clamps.a.theta;
  if (!(std::abs(turning) <= kMostTurning))
    throw LineError(fmt::format("b[2]: turns by {} rad against a (limit {})", turning, kMostTurning));
  elastica::EquilibriaOptions options;
  if (line.contains("max_energy")) {
    options.max_energy = number(line["max_energy"], "max_energy");
    if (options.max_energy < 0) throw LineError("max_energy: must not be negative");
    options.max_inflections = elastica::kMaxInflections;
  }
  if (line.contains("max_inflections")) {
    const double most = number(line["max_inflections"], "max_inflections");
    if (!(most >= 0 && most <= elastica::kMaxInflections) || most != std::floor(most))
      throw LineError(
          fmt::format("max_inflections: out of range ({}, 0 to {})", most, elastica::kMaxInflections));
    options.max_inflections = static_cast<int>(most);
  }
  const elastica::EquilibriaReport report = find_equilibria(clamps, length, options);
  Json list = Json::array();
  for (const elastica::Equilibrium& q : report.equilibria) {
    list.push_back({{"elastica", to_json(q.elastica)},
                    {"energy", q.energy},
                    {"stable", q.stable},
                    {"margin", q.margin},
                    {"inflections", q.inflections}});
  }
  return {{"equilibria", std::move(list)}, {"unresolved", report.unresolved}, {"taut", report.taut}};
}

}  // namespace

void add_curve(CLI::App& app, const Console& console, Action& action) {
  auto* curve = app.add_subcommand("curve", "Curve tools: JSON lines on stdin, JSON lines on stdout");
  curve->require_subcommand(1);
  curve->footer(
      "A bad line is answered by {\"error\": ...} at its place, and exit code 3 at the end.\n"
      "Example: echo '{\"bezier\": [[0, 0], [30, 40], [70, 40], [100, 0]]}' | hotblade curve residual");
  add_tool(*curve, "residual", "lambda-residual of cubic Beziers", action, residual,
           "echo '{\"bezier\": [[0, 0], [30, 40], [70, 40], [100, 0]]}' | hotblade curve residual");
  auto ends = std::make_shared<std::string>("free");
  auto* fitting = curve->add_subcommand("fit", "True elastica near a Bezier or points");
  fitting->add_option("--ends", *ends, "Clamped: end points and tangents are kept")
      ->check(CLI::IsMember({"free", "clamped"}))
      ->type_name("free|clamped")
      ->capture_default_str();
  fitting->footer(
      "Example: echo '{\"bezier\": [[0, 0], [30, 40], [70, 40], [100, 0]]}' | hotblade curve fit --ends "
      "clamped");
  fitting->callback([&action, ends] {
    action = [ends] { return each_line(*ends == "clamped" ? fit_clamped : fit_free); };
  });
  add_tool(*curve, "sample", "Points of an elastica, evenly spaced", action, sample,
           "echo '{\"elastica\": {\"x\": 0, \"y\": 0, \"theta\": 0.4, \"kappa\": -0.008, \"lambda1\": 0, "
           "\"lambda2\": 0.0001, \"length\": 100}, \"n\": 5}' | hotblade curve sample");
  add_tool(*curve, "equilibria", "Every shape that a blade can take between two clamps", action, equilibria,
           "echo '{\"a\": [0, 0, 0.5], \"b\": [100, 0, -0.5], \"length\": 110}' | hotblade curve equilibria");
  add_curve_arcs(*curve, action);
  add_curve_shapes(*curve, console, action);
  auto arguments = std::make_shared<ProjectArguments>();
  auto* projecting =
      curve->add_subcommand("project", "Beziers moved towards elastica, ends and end tangents kept");
  projecting
      ->add_option("--method", arguments->method,
                   "The paper's feedback or zone, or the optimum over both end edges")
      ->check(CLI::IsMember({"feedback", "optimal", "zone"}))
      ->type_name("feedback|optimal|zone");
  projecting
      ->add_option(
          "--threshold", arguments->threshold,
          "Feedback stops at this lambda-residual; optimal moves no farther than to it (0: to the least)")
      ->check(CLI::Range(0.0, 1.0));
  projecting->add_option("--branch", arguments->branch, "Branch of the optimum")
      ->check(CLI::IsMember({"inflectional", "plain", "best"}))
      ->type_name("inflectional|plain|best");
  projecting->footer(
      "Example: echo '{\"bezier\": [[0, 0], [30, 40], [70, 40], [100, 0]]}' | hotblade curve project "
      "--method optimal");
  projecting->callback([&action, arguments] {
    action = [arguments] {
      return each_line([arguments](const Json& line) { return project(line, *arguments); });
    };
  });
}

}  // namespace hotblade::pipeline
