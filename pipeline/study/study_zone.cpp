// The projection zone PI: its residuals, and how far its cubics lie from true elastica (Brander, Bærentzen,
// Fisker, Gravesen 2018, sections 3 and 5).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/projection/project_zone.hpp"
#include "pipeline/study/distribution.hpp"
#include "pipeline/study/elastica_fits.hpp"
#include "pipeline/study/random_curves.hpp"
#include "pipeline/study/study.hpp"
#include "pipeline/study/svg_plot.hpp"

namespace hotblade::pipeline::study {

namespace {

using elastica::Bezier;
using elastica::StandardPosition;

constexpr std::size_t kZoneSamples = 1'000'000, kLargeZone = 100'000, kCheckedOfLargeZone = 2000,
                      kZoneChecked = 400;
// Of the zone's curves one in this many is fitted, as in the paper: about 40,000 of 10 million.
constexpr std::size_t kFittedShare = 250;

// Uniform in the end directions that the angle constraints allow and in the edge lengths of constraint 1,
// drawn again until the curve is in the zone.
StandardPosition zone_curve(std::uint64_t seed, std::uint64_t index) {
  CurveRandom random(seed, index);
  while (true) {
    const double beta1 = random.between(std::numbers::pi / 3, 5 * std::numbers::pi / 3),
                 beta2 = random.between(std::numbers::pi / 3, 5 * std::numbers::pi / 3);
    StandardPosition s{elastica::wrapped(std::numbers::pi - beta1), elastica::wrapped(beta2), 0, 0};
    const elastica::EdgeLimits limits = elastica::edge_limits(s.a1, s.a2);
    s.l1 = random.between(limits.shortest, limits.longest);
    s.l2 = random.between(limits.shortest, limits.longest);
    if (in_projection_zone(s)) return s;
  }
}

// The paper's quality classes of the lambda-residual.
struct Class {
  const char* name;
  double below;
  const char* colour;
};
constexpr Class kClasses[] = {{"best, e < 0.22", 0.22, "#2c7fb8"},
                              {"good, e < 0.4", 0.4, "#41ab5d"},
                              {"borderline, e < 0.5", 0.5, "#feb24c"},
                              {"bad", 2, "#d7301f"}};
constexpr std::size_t kClassCount = std::size(kClasses);

std::size_t class_of(double e) {
  std::size_t k = 0;
  while (k + 1 < kClassCount && !(e < kClasses[k].below)) ++k;
  return k;
}

struct ZoneResiduals {
  std::array<std::size_t, kClassCount> counts{};
  double largest = 0;
};

ZoneResiduals zone_residuals(std::size_t samples, std::uint64_t seed,
                             const std::function<void(double)>& progress) {
  std::vector<float> e(samples);  // eight digits are plenty for counting
  over_blocks(samples, progress, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) e[i] = static_cast<float>(score(zone_curve(seed, i)));
  });
  ZoneResiduals r;
  for (const float v : e) {
    const double value = static_cast<double>(v);
    ++r.counts[class_of(value)];
    r.largest = std::max(r.largest, value);
  }
  return r;
}

// Figure 8: (phi1, phi2) of random cubics with the angle constraints, and of those in the edge-length
// constraints.
SvgPlot zone_plot(std::uint64_t seed, bool limited) {
  constexpr std::size_t kShown = 6000;
  std::array<std::vector<Eigen::Vector2d>, kClassCount> dots;
  std::array<std::size_t, kClassCount> inside{};
  for (std::size_t index = 0, shown = 0; shown < kShown; ++index) {
    const auto s = elastica::standard_position(disc_curve(seed, index, {}));
    if (!s || edges_cross(*s) || (limited && !edge_lengths_hold(*s))) continue;
    ++shown;
    const elastica::PolygonAngles a = polygon_angles(*s);
    const std::size_t k = class_of(score(*s));
    dots[k].emplace_back(a.phi1, a.phi2);
    if (inside_zone_boundary(a)) ++inside[k];
  }
  SvgPlot plot({limited ? "With length constraints" : "No length constraints", "phi1", "phi2", 0,
                2 * std::numbers::pi, 0, 2 * std::numbers::pi});
  for (std::size_t k = kClassCount; k-- > 0;) {
    plot.points(dots[k], kClasses[k].colour, 2.6, fmt::format("{}: {} inside", kClasses[k].name, inside[k]));
  }
  std::vector<Eigen::Vector2d> boundary;
  for (const elastica::PolygonAngles& a : elastica::zone_boundary(16)) boundary.emplace_back(a.phi1, a.phi2);
  plot.line(boundary, "#08306b", 2.4, "projection zone");
  return plot;
}

std::vector<Eigen::Vector2d> dots(const std::vector<FittedCurve>& fits, double FittedCurve::*value) {
  constexpr std::size_t kShown = 6000;
  std::vector<Eigen::Vector2d> list;
  for (std::size_t i = 0; i < std::min(kShown, fits.size()); ++i)
    list.emplace_back(fits[i].residual, fits[i].*value);
  return list;
}

// Figures 5 and 11: distance to the elastica against the lambda-residual.
SvgPlot distance_plot(const std::string& title, const std::string& name, const std::vector<FittedCurve>& fits,
                      double FittedCurve::*value, double most_residual, double most_distance) {
  SvgPlot plot({title, "lambda-residual", name, 0, most_residual, 0, most_distance});
  plot.points(dots(fits, value), "#2c7fb8", 2.2, "");
  for (const auto& [residual, distance] : {std::pair{0.22, 0.003}, {0.4, 0.007}, {0.5, 0.01}}) {
    if (value != &FittedCurve::l2) continue;
    const Eigen::Vector2d corner[] = {{0, distance}, {residual, distance}, {residual, 0}};
    plot.line(corner, "#d95f02", 1.2, "");
  }
  return plot;
}

nlohmann::ordered_json fit_figures(const FitSummary& f) {
  return {{"fitted", f.fitted},
          {"l2", to_json(f.l2)},
          {"h1", to_json(f.h1)},
          {"l2_over_0.007", f.over_good},
          {"l2_over_0.01", f.over_borderline},
          {"checked", f.checked},
          {"wrong_minima", f.wrong_minima}};
}

std::string fit_text(const FitSummary& f) {
  const double n = static_cast<double>(std::max<std::size_t>(1, f.fitted));
  std::string text = fmt::format("true elastica fitted to {} of them\n", f.fitted);
  text += fmt::format("  {:<34}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "", "mean", "median", "99%", "99.99%", "max");
  for (const auto& [name, d] : {std::pair{"L2", f.l2}, std::pair{"H1", f.h1}}) {
    text += fmt::format("  {:<34}{:>9.5f}{:>9.5f}{:>9.5f}{:>9.5f}{:>9.5f}\n", name, d.mean, d.median, d.p99,
                        d.p9999, d.max);
  }
  text += fmt::format("  L2 over 0.01: {} (paper: none), over 0.007: {} ({:.2f} %; paper: almost none)\n",
                      f.over_borderline, f.over_good, 100 * static_cast<double>(f.over_good) / n);
  text += fmt::format("  in a wrong minimum: {} of the {} that many starts were tried on\n", f.wrong_minima,
                      f.checked);
  return text;
}

}  // namespace

StudyReport study_zone(const StudyOptions& options) {
  const std::size_t samples = options.samples > 0 ? options.samples : kZoneSamples;
  const std::size_t fitted = std::max<std::size_t>(1, samples / kFittedShare);
  const std::size_t checked = std::min(fitted, options.checked > 0     ? options.checked
                                               : samples >= kLargeZone ? kCheckedOfLargeZone
                                                                       : kZoneChecked);
  const std::uint64_t seed = options.seed;
  const auto part = [&options](double from, double to) {
    return [&options, from, to](double share) { options.report(from + (to - from) * share); };
  };
  const ZoneResiduals r = zone_residuals(samples, seed, part(0, 0.3));
  const auto curve = [seed](std::size_t i) { return to_bezier(zone_curve(seed, i)); };
  const std::vector<FittedCurve> fits = fit_curves(fitted, curve, part(0.3, 0.6));
  const FitSummary summary = summarise(fits, check_fits(fits, checked, curve, part(0.6, 0.9)));
  const auto free_curve = [seed](std::size_t i) { return any_disc_curve(seed, i); };
  const std::vector<FittedCurve> any =
      fit_curves(std::min<std::size_t>(fitted, 4000), free_curve, part(0.9, 1));

  StudyReport report;
  report.text =
      fmt::format("{} curves in the zone: largest lambda-residual {:.4f} (paper: 0.393 in 10.7 million)\n",
                  samples, r.largest);
  report.figures = {
      {"seed", seed}, {"samples", samples}, {"largest_residual", r.largest}, {"paper_largest", 0.393}};
  for (std::size_t k = 0; k < kClassCount; ++k) {
    const double share = static_cast<double>(r.counts[k]) / static_cast<double>(samples);
    report.text += fmt::format("  {:<34}{:>9.4f} %\n", kClasses[k].name, 100 * share);
    report.figures["shares"].push_back({{"below", kClasses[k].below}, {"share", share}});
  }
  report.text += fit_text(summary);
  report.figures["fits"] = fit_figures(summary);

  const SvgPlot figure5[] = {distance_plot("Random cubics", "L2 distance", any, &FittedCurve::l2, 1, 0.04)};
  const SvgPlot figure8[] = {zone_plot(seed, false), zone_plot(seed, true)};
  const SvgPlot figure11[] = {
      distance_plot("Curves in the zone", "L2 distance", fits, &FittedCurve::l2, 0.4, 0.01),
      distance_plot("Curves in the zone", "H1 distance", fits, &FittedCurve::h1, 0.4, 0.15)};
  report.files = {{"figure5.svg", svg_page(figure5)},
                  {"figure8.svg", svg_page(figure8)},
                  {"figure11.svg", svg_page(figure11)}};
  return report;
}

}  // namespace hotblade::pipeline::study
