// hotblade curve quadratic and arcs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "elastica/arcs/arcs.hpp"
#include "elastica/quadratic/quadratic.hpp"
#include "elastica/quadratic/quadratic_tangent.hpp"
#include "pipeline/cli/curve_lines.hpp"

namespace hotblade::pipeline::curve_lines {
namespace {

using Eigen::Vector2d;
using elastica::Quadratic;

Json json_of(const Vector2d& p) {
  return {p.x(), p.y()};
}

Json json_of(const Quadratic& q) {
  return {json_of(q[0]), json_of(q[1]), json_of(q[2])};
}

Json measures(const Json& line) {
  const auto list = points(field(line, "bezier"), "bezier");
  if (list.size() != 3)
    throw LineError(
        fmt::format("bezier: has {} {} (3 needed)", list.size(), list.size() == 1 ? "point" : "points"));
  const Quadratic q{list[0], list[1], list[2]};
  const elastica::Parabola p = elastica::parabola(q);
  const char* status[] = {"ok", "folded", "line"};
  Json answer{{"length", elastica::length(q)},
              {"energy", elastica::energy(q)},
              {"parabola",
               {{"status", status[static_cast<int>(p.status)]},
                {"origin", json_of(p.origin)},
                {"axis", json_of(p.axis)},
                {"scale", p.scale},
                {"x0", p.x0},
                {"x1", p.x1}}}};
  if (line.contains("nearest")) {
    const elastica::QuadraticNearest n = elastica::nearest(q, point(line["nearest"], "nearest"));
    answer["nearest"] = {{"t", n.t}, {"point", json_of(n.point)}, {"distance", n.distance}};
  }
  return answer;
}

elastica::TangentCurves solve(const Json& line) {
  const auto ends = points(field(line, "ends"), "ends");
  if (ends.size() != 2)
    throw LineError(
        fmt::format("ends: has {} {} (2 needed)", ends.size(), ends.size() == 1 ? "point" : "points"));
  if (ends[0] == ends[1]) throw LineError("ends: coincide");
  const Json& minimise = field(line, "minimise");
  if (minimise != "length" && minimise != "energy") throw LineError("minimise: is \"length\" or \"energy\"");
  const auto objective = minimise == "length" ? elastica::Objective::kLength : elastica::Objective::kEnergy;
  if (line.contains("line")) {
    const auto on = points(line["line"], "line");
    if (on.size() != 2 || on[0] == on[1]) throw LineError("line: is two distinct points");
    return elastica::tangent_to_line(ends[0], ends[1], on[0], on[1] - on[0], objective);
  }
  const Json& circle = field(line, "circle");
  if (!circle.is_array() || circle.size() != 3) throw LineError("circle: is [cx, cy, r]");
  const double radius = number(circle[2], "circle[2]");
  if (!(radius > 0)) throw LineError(fmt::format("circle[2]: must be positive ({})", radius));
  const Vector2d centre{number(circle[0], "circle[0]"), number(circle[1], "circle[1]")};
  return elastica::tangent_to_circle(ends[0], ends[1], centre, radius, objective);
}

Json json_of(const elastica::TangentMinimum& m) {
  const char* branches[] = {"line", "closer", "farther", "end_tangent_0", "end_tangent_2", "chord"};
  return {{"bezier", json_of(m.curve)},
          {"contact", json_of(m.contact)},
          {"value", m.value},
          {"branch", branches[static_cast<int>(m.branch)]},
          {"regular", m.regular}};
}

Json tangent(const Json& line) {
  const elastica::TangentCurves curves = solve(line);
  Json candidates = Json::array();
  for (const elastica::TangentMinimum& m : curves.minima) candidates.push_back(json_of(m));
  Json answer{{"bezier", nullptr}, {"contact", nullptr}, {"value", nullptr}};
  if (curves.status == elastica::TangentStatus::kOk) {
    const elastica::TangentMinimum& best = curves.minima[curves.best];
    answer = {{"bezier", json_of(best.curve)}, {"contact", json_of(best.contact)}, {"value", best.value}};
  }
  answer["candidates"] = candidates;
  answer["status"] = curves.status == elastica::TangentStatus::kOk ? "ok" : "infeasible";
  return answer;
}

Json quadratic(const Json& line) {
  return line.is_object() && line.contains("ends") ? tangent(line) : measures(line);
}

struct ArcArguments {
  double tolerance = 0;
  std::string order = "biarc";
};

Json arcs(const Json& line, const ArcArguments& arguments) {
  const auto order = arguments.order == "triarc" ? elastica::ArcOrder::kTriarc : elastica::ArcOrder::kBiarc;
  const bool from_points = line.is_object() && line.contains("points");
  const elastica::ArcFit fit =
      from_points ? elastica::fit_arcs(points(line["points"], "points"), arguments.tolerance, order)
                  : elastica::fit_arcs(elastica_of(line), arguments.tolerance, order);
  Json list = Json::array();
  for (const elastica::Arc& a : fit.arcs) {
    list.push_back({{"start", {a.x, a.y}}, {"theta", a.theta}, {"kappa", a.kappa}, {"length", a.length}});
  }
  return {{"arcs", list}, {"error_bound", fit.error_bound}, {"length", fit.length}};
}

}  // namespace

void add_curve_arcs(CLI::App& curve, Action& action) {
  add_tool(
      curve, "quadratic", "Length, energy and nearest point of quadratic Beziers; tangent ones", action,
      quadratic,
      "echo '{\"bezier\": [[0, 0], [50, 60], [100, 0]], \"nearest\": [40, 10]}' | hotblade curve quadratic");
  auto arguments = std::make_shared<ArcArguments>();
  auto* fitting = curve.add_subcommand("arcs", "Elastica or points as circular arcs of the same length");
  fitting->add_option("--tolerance", arguments->tolerance, "Largest distance, in the curve's unit")
      ->required()
      ->check(CLI::Range(1e-9, 1e9));
  fitting->add_option("--order", arguments->order, "Arcs a piece: two, or three that keep its end curvatures")
      ->check(CLI::IsMember({"biarc", "triarc"}))
      ->type_name("biarc|triarc");
  fitting->footer(
      "Example: echo '{\"elastica\": {\"x\": 0, \"y\": 0, \"theta\": 0.4, \"kappa\": -0.008, \"lambda1\": 0, "
      "\"lambda2\": 0.0001, \"length\": 100}}' | hotblade curve arcs --tolerance 0.01");
  fitting->callback([&action, arguments] {
    action = [arguments] {
      return each_line([arguments](const Json& line) { return arcs(line, *arguments); });
    };
  });
}

}  // namespace hotblade::pipeline::curve_lines
