#include "pipeline/study/quadratic_plots.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "pipeline/study/quadratic_oracle.hpp"
#include "pipeline/study/svg_plot.hpp"

namespace hotblade::pipeline::study {

namespace {

using Eigen::Vector2d;
using elastica::Objective;
using elastica::Quadratic;
using Points = std::vector<Vector2d>;
constexpr int kSetPoints = 720;

Points closed(Points points) {
  if (!points.empty()) points.push_back(points.front());
  return points;
}

Points level_set(const TangentProblem& p, double level) {
  return closed(p.objective == Objective::kLength
                    ? elastica::length_level_set(p.b0, p.b2, level, kSetPoints)
                    : elastica::energy_level_set(p.b0, p.b2, level, kSetPoints));
}

// Axes of one scale around a point; as wide as high over the plot's inner size.
Axes around(const std::string& title, const Vector2d& centre, double half_width) {
  const double half_height = half_width * 364 / 468;
  return {title,
          "x of b1",
          "y of b1",
          centre.x() - half_width,
          centre.x() + half_width,
          centre.y() - half_height,
          centre.y() + half_height};
}

SvgPlot level_plot(const char* name, Objective objective, std::initializer_list<double> levels) {
  constexpr const char* kColours[] = {"#d7301f", "#dd1c8f", "#238b45", "#2c7fb8", "#6a51a3"};
  SvgPlot plot(around(fmt::format("{} of b0 = (-1, 0), b1, b2 = (1, 0)", name), {0, 0}, 2.4));
  TangentProblem p;
  p.b0 = {-1, 0};
  p.b2 = {1, 0};
  p.objective = objective;
  std::size_t k = 0;
  for (const double level : levels)
    plot.line(level_set(p, level), kColours[k++], 1.6, fmt::format("{:g}", level));
  const Vector2d ends[] = {p.b0, p.b2};
  plot.points(ends, "#000000", 7, "");
  return plot;
}

void draw_locus(SvgPlot& plot, const TangentProblem& p, const char* colour, const char* name) {
  if (!p.circle) {  // all on the parallel through the solution
    const Vector2d u = p.direction.normalized(), on = p.solve().minima.front().curve[1];
    const Vector2d ends[] = {on - 20 * u, on + 20 * u};
    plot.line(ends, colour, 1.4, name);
    return;
  }
  constexpr int kSteps = 4000;
  constexpr double kFar = 20;  // well outside the picture
  Points piece;
  bool named = false;
  const auto flush = [&] {
    if (piece.size() > 1) plot.line(piece, colour, 1.4, named ? "" : name);
    named = named || piece.size() > 1;
    piece.clear();
  };
  for (int i = 0; i <= kSteps; ++i) {
    const Vector2d b1 = locus(p, 2 * std::numbers::pi * i / kSteps);
    if (b1.allFinite() && b1.norm() < kFar) {
      piece.push_back(b1);
    } else {
      flush();
    }
  }
  flush();
}

void draw_target(SvgPlot& plot, const TangentProblem& p) {
  Points target;
  for (int i = 0; i <= 120; ++i) {
    const double a = 2 * std::numbers::pi * i / 120;
    if (p.circle) target.emplace_back(p.place + p.radius * Vector2d(std::cos(a), std::sin(a)));
  }
  const Vector2d far = 20 * p.direction.normalized();
  if (!p.circle) target = {p.place - far, p.place + far};
  plot.line(target, "#888888", 2.5, p.circle ? "circle" : "line");
}

SvgPlot tangent_plot(const TangentProblem& p) {
  const elastica::TangentCurves solved = p.solve();
  const elastica::TangentMinimum& best = solved.minima[solved.best];
  const bool is_length = p.objective == Objective::kLength;
  SvgPlot plot(around(fmt::format("Least {} {:.4f}, tangent to a {}", is_length ? "length" : "energy",
                                  best.value, p.circle ? "circle" : "line"),
                      {0, -0.8}, 4));
  draw_target(plot, p);
  draw_locus(plot, p, "#8c510a", "tangency locus of b1");
  plot.line(level_set(p, best.value), "#d7301f", 1.4, is_length ? "same length" : "same energy");
  Points curve;
  for (int i = 0; i <= 100; ++i) curve.push_back(elastica::point_at(best.curve, i / 100.0));
  plot.line(best.curve, "#9ecae1", 1, "control polygon");
  plot.line(curve, "#000000", 2.2, "curve");
  const Vector2d marked[] = {best.curve[1], best.contact};
  plot.points(marked, "#2c7fb8", 7, "b1, contact");
  return plot;
}

}  // namespace

std::string level_set_figure() {
  const SvgPlot plots[] = {level_plot("Length", Objective::kLength, {2.02, 2.1, 2.3, 2.7, 3.2}),
                           level_plot("Energy", Objective::kEnergy, {0.1, 1, 2, 3})};
  return svg_page(plots);
}

std::string tangent_figure() {
  TangentProblem p;
  p.b0 = {-1.6, 0.5};
  p.b2 = {1.4, 1.1};
  p.place = {0, -0.4};
  p.direction = {4, 1};
  p.radius = 0.7;
  std::vector<SvgPlot> plots;
  for (const bool circle : {false, true}) {
    for (const Objective objective : {Objective::kLength, Objective::kEnergy}) {
      p.circle = circle;
      p.objective = objective;
      plots.push_back(tangent_plot(p));
    }
  }
  return svg_page(plots);
}

}  // namespace hotblade::pipeline::study
