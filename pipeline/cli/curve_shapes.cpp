// hotblade curve features, nearest, spline and split.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "elastica/curve/closed_form.hpp"
#include "elastica/curve/features.hpp"
#include "elastica/projection/spline.hpp"
#include "elastica/quadratic/quadratic_chain.hpp"
#include "gpu/curve/curve_distance.hpp"
#include "pipeline/cli/backend_option.hpp"
#include "pipeline/cli/curve_lines.hpp"

namespace hotblade::pipeline::curve_lines {
namespace {

using Eigen::Vector2d;
using elastica::Elastica;

// Places on a curve: arc lengths and points.
Json places(const Elastica& e, const std::vector<double>& s) {
  std::vector<double> x(s.size()), y(s.size());
  elastica::sample_points(e, s, {x, y, {}, {}, {}});
  Json list = Json::array();
  for (std::size_t i = 0; i < s.size(); ++i) list.push_back({{"s", s[i]}, {"point", {x[i], y[i]}}});
  return list;
}

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

// Null where the segment turns too little to show a shape.
Json shape_of(const Elastica& e) {
  const auto form = elastica::ClosedForm::of(e);
  if (!form) return nullptr;
  const char* regimes[] = {"inflectional", "separatrix", "winding"};
  const elastica::Shape& shape = form->shape();
  return {{"regime", regimes[static_cast<int>(shape.regime)]},
          {"modulus", number_or_null(shape.modulus)},
          {"axis", shape.axis}};
}

Json features(const Json& line) {
  const Elastica e = elastica_of(line);
  const auto period = elastica::curvature_period(e);
  Json crossings = Json::array();
  for (const elastica::Crossing& c : elastica::self_intersections(e)) {
    std::vector<double> x(1), y(1);
    elastica::sample_points(e, std::vector{c.first}, {x, y, {}, {}, {}});
    crossings.push_back({{"s", {c.first, c.second}}, {"point", {x[0], y[0]}}});
  }
  return {{"shape", shape_of(e)},
          {"period", period ? Json(*period) : Json(nullptr)},
          {"inflections", places(e, elastica::inflections(e))},
          {"vertices", places(e, elastica::vertices(e))},
          {"self_intersections", crossings}};
}

struct NearestArguments {
  std::string backend = "cpu";
  gpu::BackendUse used;
};

struct NearestPlaces {
  std::vector<double> distance, t;
  double bound = 0;  // of what the curve that was asked strays from the one that was given
};

NearestPlaces nearest_to(const gpu::CurveDistance& curve, const std::vector<Vector2d>& points,
                         NearestArguments& arguments) {
  std::vector<double> x, y;
  for (const Vector2d& p : points) {
    x.push_back(p.x());
    y.push_back(p.y());
  }
  NearestPlaces places{std::vector<double>(x.size()), std::vector<double>(x.size())};
  (void)curve.query(x, y, places.distance, places.t);
  arguments.used = curve.used();
  return places;
}

// Newton's method for the foot of a point, from the arc length of its foot on the chain.
double foot_on(const elastica::ElasticaCurve& curve, const Vector2d& q, double s) {
  constexpr int kSteps = 4;
  double best = s, least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    const elastica::CurvePoint p = curve.at(s);
    const Vector2d r = p.position() - q, t = p.tangent();
    if (r.norm() < least) {
      least = r.norm();
      best = s;
    }
    const double slope = 1 + p.kappa * (r.y() * t.x() - r.x() * t.y());
    if (!(slope > 0)) break;
    s = std::clamp(s - r.dot(t) / slope, 0.0, curve.elastica().length);
  }
  return best;
}

// By a chain of quadratics that strays from the elastica by less than the tolerance.
NearestPlaces nearest_to_elastica(const Json& line, const std::vector<Vector2d>& points,
                                  NearestArguments& arguments) {
  const Elastica e = elastica_of(line);
  constexpr double kToleranceRel = 1e-9;  // of the length
  const double tolerance =
      line.contains("tolerance") ? number(line["tolerance"], "tolerance") : kToleranceRel * e.length;
  if (!(tolerance > 0)) throw LineError("tolerance: must be positive");
  const elastica::QuadraticChain chain = elastica::quadratic_chain(e, tolerance);
  NearestPlaces places = nearest_to(
      gpu::CurveDistance::to_quadratics(chain.pieces, backend_named(arguments.backend)), points, arguments);
  const elastica::ElasticaCurve curve(e);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto piece = std::min(static_cast<std::size_t>(places.t[i]), chain.pieces.size() - 1);
    const double from = chain.arc_length[piece], to = chain.arc_length[piece + 1];
    places.t[i] = foot_on(curve, points[i], from + (places.t[i] - static_cast<double>(piece)) * (to - from));
  }
  places.bound = chain.bound;
  return places;
}

Json nearest(const Json& line, NearestArguments& arguments) {
  const std::vector<Vector2d> to = points(field(line, "points"), "points");
  const gpu::Backend backend = backend_named(arguments.backend);
  NearestPlaces places;
  if (line.contains("elastica")) {
    places = nearest_to_elastica(line, to, arguments);
  } else {
    const auto control = points(field(line, "bezier"), "bezier");
    if (control.size() != 3 && control.size() != 4)
      throw LineError(fmt::format("bezier: has {} {} (3 or 4 needed)", control.size(),
                                  control.size() == 1 ? "point" : "points"));
    places =
        control.size() == 4
            ? nearest_to(
                  gpu::CurveDistance::to_cubic({control[0], control[1], control[2], control[3]}, backend), to,
                  arguments)
            : nearest_to(
                  gpu::CurveDistance::to_quadratics(
                      std::vector<std::array<Vector2d, 3>>{{control[0], control[1], control[2]}}, backend),
                  to, arguments);
  }
  return {{"distance", places.distance}, {"parameter", places.t}, {"bound", places.bound}};
}

// Answers all lines, and says where a device that was asked for did not answer.
Exit nearest_lines(NearestArguments arguments, const Console& console) {
  const Exit exit = each_line([&](const Json& line) { return nearest(line, arguments); });
  if (backend_named(arguments.backend) == gpu::Backend::kOpenCl &&
      arguments.used.backend != gpu::Backend::kOpenCl && !arguments.used.reason.empty())
    console.warn("warning: " + arguments.used.reason);
  return exit;
}

Json spline(const Json& line, const std::string& continuity) {
  const Json& given = field(line, "chain");
  if (!given.is_array() || given.empty() || given.size() > kMostPoints / 4)
    throw LineError(fmt::format("chain: not a list of 1 to {} Beziers", kMostPoints / 4));
  std::vector<elastica::Bezier> chain;
  for (std::size_t i = 0; i < given.size(); ++i)
    chain.push_back(cubic(given[i], fmt::format("chain[{}]", i)));
  const elastica::SplineProjection p =
      project_spline(chain, continuity == "c1" ? elastica::Continuity::kC1 : elastica::Continuity::kG1);
  Json moved = Json::array();
  for (const elastica::Bezier& b : p.chain) moved.push_back(to_json(b));
  return {{"chain", moved}, {"lambda_residuals", p.residuals}, {"status", name(p.status)}};
}

struct SplitArguments {
  double tolerance = 0;
  int candidates = 16;
};

Json split(const Json& line, const SplitArguments& arguments) {
  const elastica::ElasticaSplit s = elastica::split_to_elastica(cubic(field(line, "bezier"), "bezier"),
                                                                arguments.tolerance, arguments.candidates);
  Json pieces = Json::array();
  for (const elastica::SplitPiece& piece : s.pieces) {
    pieces.push_back({{"from", piece.from},
                      {"to", piece.to},
                      {"elastica", to_json(piece.elastica)},
                      {"error_bound", piece.deviation}});
  }
  return {{"pieces", pieces}, {"status", s.within ? "ok" : "not_reached"}};
}

void add_nearest(CLI::App& curve, const Console& console, Action& action) {
  auto arguments = std::make_shared<NearestArguments>();
  auto* command = curve.add_subcommand("nearest", "Distances from points to a Bezier or an elastica");
  add_backend_option(*command, arguments->backend);
  command->footer(
      "Example: echo '{\"points\": [[50, 0]], \"bezier\": [[0, 0], [30, 40], [70, 40], [100, 0]]}' | "
      "hotblade curve nearest");
  command->callback([&action, &console, arguments] {
    action = [&console, arguments] { return nearest_lines(*arguments, console); };
  });
}

void add_spline(CLI::App& curve, Action& action) {
  auto continuity = std::make_shared<std::string>("g1");
  auto* command = curve.add_subcommand("spline", "Chains of Beziers projected near elastica, joints kept");
  command
      ->add_option("--continuity", *continuity,
                   "At the joints: one tangent direction (g1), or one derivative (c1)")
      ->check(CLI::IsMember({"g1", "c1"}))
      ->type_name("g1|c1")
      ->capture_default_str();
  command->footer(
      "Example: echo '{\"chain\": [[[0, 0], [10, 20], [30, 30], [50, 30]], [[50, 30], [70, 30], [90, 20], "
      "[100, 0]]]}' | "
      "hotblade curve spline --continuity c1");
  command->callback([&action, continuity] {
    action = [continuity] {
      return each_line([continuity](const Json& line) { return spline(line, *continuity); });
    };
  });
}

void add_split(CLI::App& curve, Action& action) {
  auto arguments = std::make_shared<SplitArguments>();
  auto* command = curve.add_subcommand("split", "Beziers cut into the fewest elastica within a tolerance");
  command->add_option("--tolerance", arguments->tolerance, "Largest distance, in the lines' own unit")
      ->required()
      ->check(CLI::PositiveNumber)
      ->type_name("T");
  command->add_option("--candidates", arguments->candidates, "Joints are sought at this many places less one")
      ->check(CLI::Range(1, 256))
      ->type_name("N")
      ->capture_default_str();
  command->footer(
      "Example: echo '{\"bezier\": [[0, 0], [30, 40], [70, 40], [100, 0]]}' | hotblade curve split "
      "--tolerance 0.5");
  command->callback([&action, arguments] {
    action = [arguments] {
      return each_line([arguments](const Json& line) { return split(line, *arguments); });
    };
  });
}

}  // namespace

void add_curve_shapes(CLI::App& curve, const Console& console, Action& action) {
  add_tool(curve, "features", "Shape, inflections, vertices and self-intersections of elastica", action,
           features,
           "echo '{\"elastica\": {\"x\": 0, \"y\": 0, \"theta\": 0.4, \"kappa\": -0.008, \"lambda1\": 0, "
           "\"lambda2\": 0.0001, \"length\": 100}}' | hotblade curve features");
  add_nearest(curve, console, action);
  add_spline(curve, action);
  add_split(curve, action);
}

}  // namespace hotblade::pipeline::curve_lines
