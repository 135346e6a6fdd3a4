// What the curve tools share: JSON lines in, JSON lines out.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "elastica/bezier/bezier.hpp"
#include "elastica/curve/elastica.hpp"
#include "pipeline/cli/command.hpp"

namespace hotblade::pipeline::curve_lines {

using Json = nlohmann::ordered_json;

// A line that cannot be used; what() is what its answer says.
struct LineError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The largest number that is taken: larger ones lose the digits that a curve's shape needs.
inline constexpr double kLargest = 1e9;
inline constexpr std::size_t kMostPoints = 1'000'000;

// The value of a field of a line, as what it has to be; each throws LineError with the field's name.
[[nodiscard]] const Json& field(const Json& line, const char* name);
[[nodiscard]] double number(const Json& value, const std::string& name);
[[nodiscard]] Eigen::Vector2d point(const Json& value, const std::string& name);
[[nodiscard]] std::vector<Eigen::Vector2d> points(const Json& value, const std::string& name);
[[nodiscard]] elastica::Bezier cubic(const Json& value, const std::string& name);
[[nodiscard]] elastica::Elastica elastica_of(const Json& line);

[[nodiscard]] Json to_json(const elastica::Bezier& b);
[[nodiscard]] Json to_json(const elastica::Elastica& e);

// Answers every line of stdin at its place; exit code 3 when any was bad.
[[nodiscard]] Exit each_line(const std::function<Json(const Json&)>& answer);

// Adds a subcommand without options.
void add_tool(CLI::App& curve, const char* name, const char* about, Action& action,
              std::function<Json(const Json&)> tool, const char* example);

// Adds the tools quadratic and arcs.
void add_curve_arcs(CLI::App& curve, Action& action);

// The tools features, nearest, spline and split.
void add_curve_shapes(CLI::App& curve, const Console& console, Action& action);

}  // namespace hotblade::pipeline::curve_lines
