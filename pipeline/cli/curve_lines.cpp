#include "pipeline/cli/curve_lines.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "pipeline/settings/json_bytes.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline::curve_lines {

using elastica::Elastica;

const Json& field(const Json& line, const char* name) {
  if (!line.is_object() || !line.contains(name))
    throw LineError(fmt::format("{}: missing: one object a line", name));
  return line[name];
}

double number(const Json& value, const std::string& name) {
  if (!value.is_number()) throw LineError(fmt::format("{}: not a number", name));
  const double v = value.get<double>();
  if (!(std::abs(v) <= kLargest))
    throw LineError(fmt::format("{}: out of range ({}, limit {})", name, v, kLargest));
  return v;
}

Eigen::Vector2d point(const Json& value, const std::string& name) {
  if (!value.is_array() || value.size() != 2) throw LineError(name + ": a point is [x, y]");
  return {number(value[0], name), number(value[1], name)};
}

std::vector<Eigen::Vector2d> points(const Json& value, const std::string& name) {
  if (!value.is_array() || value.size() > kMostPoints) {
    throw LineError(fmt::format("{}: not a list of at most {} points", name, kMostPoints));
  }
  std::vector<Eigen::Vector2d> list;
  for (std::size_t i = 0; i < value.size(); ++i) {
    list.push_back(point(value[i], fmt::format("{}[{}]", name, i)));
  }
  return list;
}

elastica::Bezier cubic(const Json& value, const std::string& name) {
  const auto list = points(value, name);
  if (list.size() != 4)
    throw LineError(
        fmt::format("{}: has {} {} (4 needed)", name, list.size(), list.size() == 1 ? "point" : "points"));
  return {list[0], list[1], list[2], list[3]};
}

Elastica elastica_of(const Json& line) {
  const Json& e = field(line, "elastica");
  const auto value = [&e](const char* name) {
    return number(field(e, name), std::string("elastica.") + name);
  };
  const Elastica curve{value("x"),       value("y"),       value("theta"), value("kappa"),
                       value("lambda1"), value("lambda2"), value("length")};
  if (!(curve.length > 0)) throw LineError("elastica.length: must be positive");
  return curve;
}

Json to_json(const elastica::Bezier& b) {
  Json list = Json::array();
  for (const Eigen::Vector2d& p : b) list.push_back({p.x(), p.y()});
  return list;
}

Json to_json(const Elastica& e) {
  return {{"x", e.x},
          {"y", e.y},
          {"theta", e.theta},
          {"kappa", e.kappa},
          {"lambda1", e.lambda1},
          {"lambda2", e.lambda2},
          {"length", e.length}};
}

// Answers every line at its place; exit code 3 when any was bad.
Exit each_line(const std::function<Json(const Json&)>& answer) {
  Exit result = Exit::kOk;
  std::string text;
  for (std::size_t number = 1; std::getline(std::cin, text) && !interrupted(); ++number) {
    Json out, id;
    try {
      const Json line = whole_json<Json>(text);
      if (line.is_object() && line.contains("id")) id = line["id"];
      out = answer(line);
    } catch (const nlohmann::json::exception&) {
      out = {{"error", fmt::format("line {}: not JSON: one object a line", number)}};
    } catch (const std::exception& error) {  // a LineError, or a curve that cannot be evaluated
      out = {{"error", fmt::format("line {}: {}", number, error.what())}};
    }
    if (out.contains("error")) result = Exit::kBadInput;
    if (!id.is_null()) out["id"] = id;
    std::cout << json_text(out) << "\n";
  }
  return interrupted() ? Exit::kInterrupted : result;
}

void add_tool(CLI::App& curve, const char* name, const char* about, Action& action,
              std::function<Json(const Json&)> tool, const char* example) {
  auto* command = curve.add_subcommand(name, about);
  command->footer(std::string("Example: ") + example);
  command->callback([&action, tool] { action = [tool] { return each_line(tool); }; });
}

}  // namespace hotblade::pipeline::curve_lines
