#include "pipeline/study/arc_plots.hpp"

#include <fmt/format.h>

#include <cmath>

#include "elastica/arcs/arcs.hpp"
#include "pipeline/study/arc_measures.hpp"

namespace hotblade::pipeline::study {

namespace {

using Eigen::Vector2d;
using elastica::Arc;
using elastica::ArcOrder;
using elastica::CurvePoint;
using elastica::Elastica;

using Points = std::vector<Vector2d>;

Points drawn(std::span<const Arc> arcs) {
  constexpr int kStepsOfArc = 48;
  Points line;
  for (const Arc& arc : arcs) {
    for (int i = 0; i <= kStepsOfArc; ++i)
      line.push_back(point_at(arc, arc.length * i / kStepsOfArc).position());
  }
  return line;
}

Points drawn(const Elastica& e) {
  Points line;
  for (const CurvePoint& p : elastica::sample(e, 400)) line.push_back(p.position());
  return line;
}

Points starts(std::span<const Arc> arcs) {
  Points list;
  for (const Arc& arc : arcs) list.emplace_back(arc.x, arc.y);
  return list;
}

// Axes of equal scales around a centre; `width` in the data's unit.
Axes equal_axes(const std::string& title, const Vector2d& centre, double width) {
  constexpr double kHeightOfWidth = 364.0 / 468.0;  // of the plot's axes
  const double height = kHeightOfWidth * width;
  return {title,
          "x",
          "y",
          centre.x() - width / 2,
          centre.x() + width / 2,
          centre.y() - height / 2,
          centre.y() + height / 2};
}

SvgPlot spiral_plot() {
  // A blade from almost straight to tightly bent, between two of its vertices.
  const Elastica e{0, 0, -0.9, 0.05, 0, 3.2, 1.55};
  const elastica::ElasticaCurve curve(e);
  const elastica::SpiralEnds ends{curve.at(0), curve.at(e.length), e.length};
  const auto family = elastica::BiarcFamily::between(ends.a, ends.b);
  const auto lens = elastica::bilens(*family, ends.a.kappa, ends.b.kappa);
  const auto biarc = elastica::spiral_arcs(ends, ArcOrder::kBiarc),
             triarc = elastica::spiral_arcs(ends, ArcOrder::kTriarc);
  SvgPlot plot(equal_axes(fmt::format("A spiral in its bilens, {:.3f} wide", lens->width), {0.6, -0.1}, 1.7));
  plot.line(drawn(family->arcs(lens->p1)), "#a1d99b", 1.5, "bilens: first curvature");
  plot.line(drawn(family->arcs(lens->p2)), "#fdae6b", 1.5, "bilens: last curvature");
  plot.line(drawn(e), "#bbbbbb", 5, "spiral");
  plot.line(drawn(biarc->arcs), "#2c7fb8", 1.5, "biarc of its length");
  plot.line(drawn(triarc->arcs), "#d7301f", 1.5, "triarc of its length");
  plot.points(starts(std::span(biarc->arcs).subspan(1)), "#2c7fb8", 8, "");
  plot.points(starts(std::span(triarc->arcs).subspan(1)), "#d7301f", 8, "");
  return plot;
}

SvgPlot elastica_plot() {
  const Elastica e{0, 0, 0.9, 0, 0, -1.1e-4, 700};
  const elastica::ArcFit fit = fit_arcs(e, 2, ArcOrder::kBiarc);
  SvgPlot plot(
      equal_axes(fmt::format("An elastica within {:.1f} mm: {} arcs", fit.error_bound, fit.arcs.size()),
                 {-60, 110}, 560));
  plot.line(drawn(e), "#bbbbbb", 5, "elastica");
  plot.line(drawn(fit.arcs), "#2c7fb8", 1.5, "biarcs of its length");
  plot.points(starts(fit.arcs), "#2c7fb8", 7, "");
  return plot;
}

// The end of two arcs joined smoothly from the origin.
Vector2d end_of(double k1, double l1, double k2, double l2) {
  const CurvePoint joint = point_at(Arc{0, 0, 0, k1, l1}, l1);
  return point_at(Arc{joint.x, joint.y, joint.theta, k2, l2}, l2).position();
}

SvgPlot reach_plot(std::uint64_t seed, const std::string& figure, double k1, double k2,
                   const Vector2d& centre, double width) {
  constexpr std::uint64_t kSpirals = 3000;
  constexpr int kSteps = 200;
  Points ends, gamma1, gamma2;
  for (std::uint64_t i = 0; i < kSpirals; ++i) {
    CurveRandom random(seed, i);
    // Between two curvatures inside the range, so that the inside of the region is met too.
    double a = k1 + (k2 - k1) * random.unit(), b = k1 + (k2 - k1) * random.unit();
    if ((a - b) * (k1 - k2) < 0) std::swap(a, b);
    if (i % 2 == 0) a = k1, b = k2;
    const auto spiral = random_spiral(random, a, b, 1);
    ends.push_back(point_at(spiral.back(), spiral.back().length).position());
  }
  for (int i = 0; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps;
    gamma1.push_back(end_of(k1 + t * (k2 - k1), 1, 0, 0));
    gamma2.push_back(end_of(k1, 1 - t, k2, t));
  }
  SvgPlot plot(equal_axes(fmt::format("Ends of spirals, {:g} to {:g} ({})", k1, k2, figure), centre, width));
  plot.points(ends, "#9ecae1", 2.2, "random spirals");
  plot.line(gamma1, "#238b45", 2, "Gamma1: one arc");
  plot.line(gamma2, "#d7301f", 2, "Gamma2: two arcs");
  return plot;
}

}  // namespace

std::string arc_figure() {
  const SvgPlot plots[] = {spiral_plot(), elastica_plot()};
  return svg_page(plots);
}

std::string reach_figure(std::uint64_t seed) {
  const SvgPlot plots[] = {reach_plot(seed, "figure 5", 0.7, 3.5, {0.35, 0.45}, 1.5),
                           reach_plot(seed, "figure 6", 3.0, 2.2, {0.2, 0.65}, 0.5),
                           reach_plot(seed, "figure 7", 1.0, 2.0, {0.65, 0.58}, 0.6)};
  return svg_page(plots);
}

}  // namespace hotblade::pipeline::study
