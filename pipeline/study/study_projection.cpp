// The projections on the paper's random cubics (Brander, Bærentzen, Fisker, Gravesen 2018, section 6).
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "elastica/bezier/standard_position.hpp"
#include "elastica/projection/project.hpp"
#include "pipeline/study/distribution.hpp"
#include "pipeline/study/random_curves.hpp"
#include "pipeline/study/study.hpp"
#include "pipeline/study/svg_plot.hpp"

namespace hotblade::pipeline::study {

namespace {

using elastica::Bezier;
using elastica::Projection;
using elastica::WantedBranch;

// One pair of angle constraints with what the paper prints for its feedback projection; 0: not printed.
struct Case {
  const char* name;
  elastica::AngleConstraints constraints;
  Distribution paper;
};
constexpr Case kCases[] = {
    {"pi/3, 0.4 pi", {std::numbers::pi / 3, 0.4 * std::numbers::pi}, {0.048, 0.042, 0.15, 0.22, 0.26}},
    {"pi/4, 0.6 pi", {std::numbers::pi / 4, 0.6 * std::numbers::pi}, {0.06, 0.043, 0, 0, 0.42}},
    {"pi/6, 0.75 pi", {std::numbers::pi / 6, 0.75 * std::numbers::pi}, {0.10, 0.06, 0, 0, 0.71}},
};
// Large samples are checked on a subset that pins its 99% down; small ones are for a look.
constexpr std::size_t kSeeds = 3, kProjectionSamples = 100'000, kLargeProjection = 100'000,
                      kCheckedOfLargeProjection = 5000, kProjectionsChecked = 100;
// Grid of the brute force: neighbours differ by 4%; its best local minima are refined.
constexpr elastica::SearchOptions kBruteForce{129, 24};

// What must never happen, over all projections.
struct Faults {
  double end_point = 0, tangent = 0;                        // largest change, in chords and rad
  std::size_t crossing_feedback = 0, crossing_optimal = 0;  // results whose first and third edge cross
};

void record(const Bezier& before, const Bezier& after, Faults& faults, std::size_t& crossing) {
  const double chord = (before[3] - before[0]).norm();
  for (const auto& [end, inner] : {std::pair<std::size_t, std::size_t>{0, 1}, {3, 2}}) {
    faults.end_point = std::max(faults.end_point, (after[end] - before[end]).norm() / chord);
    const Eigen::Vector2d was = (before[inner] - before[end]).normalized(),
                          now = (after[inner] - after[end]).normalized();
    faults.tangent = std::max(faults.tangent, (was - now).norm());
  }
  if (const auto s = elastica::standard_position(after); s && edges_cross(*s)) ++crossing;
}

struct Outcome {
  std::vector<double> feedback, optimal, optimal_checked, brute;
  Faults faults;
};

Outcome run_case(const Case& c, std::uint64_t seed, std::size_t samples, std::size_t checked,
                 const std::function<void(double)>& progress) {
  Outcome o;
  o.feedback.resize(samples);
  o.optimal.resize(samples);
  o.brute.resize(checked);
  std::vector<Faults> faults(samples);
  over_blocks(
      samples, [&](double share) { progress(0.5 * share); },
      [&](std::size_t first, std::size_t end) {
        std::vector<Bezier> curves;
        for (std::size_t i = first; i < end; ++i) curves.push_back(disc_curve(seed, i, c.constraints));
        std::vector<Projection> optimal(curves.size());
        elastica::project_optimal(curves, WantedBranch::kBest, optimal);
        for (std::size_t i = first; i < end; ++i) {
          const Bezier& b = curves[i - first];
          const Projection feedback = elastica::project_feedback(b, 0);
          o.feedback[i] = feedback.lambda_residual;
          o.optimal[i] = optimal[i - first].lambda_residual;
          record(b, feedback.bezier, faults[i], faults[i].crossing_feedback);
          record(b, optimal[i - first].bezier, faults[i], faults[i].crossing_optimal);
        }
      });
  over_blocks(
      checked, [&](double share) { progress(0.5 + 0.5 * share); },
      [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
          const Bezier b = disc_curve(seed, i, c.constraints);
          o.brute[i] = elastica::project_optimal_search(b, WantedBranch::kBest, kBruteForce).lambda_residual;
        }
      });
  for (const Faults& f : faults) {
    o.faults.end_point = std::max(o.faults.end_point, f.end_point);
    o.faults.tangent = std::max(o.faults.tangent, f.tangent);
    o.faults.crossing_feedback += f.crossing_feedback;
    o.faults.crossing_optimal += f.crossing_optimal;
  }
  o.optimal_checked.assign(o.optimal.begin(), o.optimal.begin() + static_cast<std::ptrdiff_t>(checked));
  return o;
}

std::string row(const std::string& name, const Distribution& d) {
  const auto cell = [](double v) { return v == 0 ? fmt::format("{:>9}", "-") : fmt::format("{:>9.4f}", v); };
  return fmt::format("  {:<34}{}{}{}{}{}\n", name, cell(d.mean), cell(d.median), cell(d.p99), cell(d.p9999),
                     cell(d.max));
}

// Shares of curves at or below each residual, for the plot.
std::vector<Eigen::Vector2d> shares(std::vector<double> values, double largest) {
  std::sort(values.begin(), values.end());
  std::vector<Eigen::Vector2d> line;
  constexpr int kSharesDrawn = 200;
  for (int k = 0; k <= kSharesDrawn; ++k) {
    const double e = largest * k / kSharesDrawn;
    const auto below = std::upper_bound(values.begin(), values.end(), e) - values.begin();
    line.emplace_back(e, static_cast<double>(below) / static_cast<double>(values.size()));
  }
  return line;
}

SvgPlot plot_case(const Case& c, const Outcome& o) {
  constexpr double kLargest = 0.3;
  SvgPlot plot({std::string("Angle constraints ") + c.name, "lambda-residual after projection",
                "share of curves at or below", 0, kLargest, 0, 1});
  plot.line(shares(o.feedback, kLargest), "#d95f02", 1.8, "feedback (paper)");
  plot.line(shares(o.optimal, kLargest), "#1b6ca8", 1.8, "optimal");
  plot.line(shares(o.brute, kLargest), "#333333", 0.9, "brute force");
  return plot;
}

std::string tables(const Case& c, std::uint64_t seed, const Outcome& o) {
  std::string text = fmt::format("angle constraints {}, seed {}\n", c.name, seed);
  text += fmt::format("  {:<34}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "lambda-residual", "mean", "median", "99%",
                      "99.99%", "max");
  text += row("paper, feedback", c.paper);
  text += row(fmt::format("feedback, {} curves", o.feedback.size()), distribution(o.feedback));
  text += row(fmt::format("optimal, {} curves", o.optimal.size()), distribution(o.optimal));
  text += row(fmt::format("optimal, first {}", o.brute.size()), distribution(o.optimal_checked));
  text += row(fmt::format("brute force, the same {}", o.brute.size()), distribution(o.brute));
  text += fmt::format(
      "  largest move of an end point {:.1e} chords, of an end tangent {:.1e} rad; crossing edges: feedback "
      "{}, "
      "optimal {}\n\n",
      o.faults.end_point, o.faults.tangent, o.faults.crossing_feedback, o.faults.crossing_optimal);
  return text;
}

nlohmann::ordered_json figures(const Case& c, std::uint64_t seed, const Outcome& o) {
  return {
      {"angle_constraints", {c.constraints.from_chord, c.constraints.difference}},
      {"seed", seed},
      {"samples", o.feedback.size()},
      {"checked", o.brute.size()},
      {"paper", to_json(c.paper)},
      {"feedback", to_json(distribution(o.feedback))},
      {"optimal", to_json(distribution(o.optimal))},
      {"optimal_checked", to_json(distribution(o.optimal_checked))},
      {"brute_force", to_json(distribution(o.brute))},
      {"end_point_moved", o.faults.end_point},
      {"tangent_moved", o.faults.tangent},
      {"crossing_edges", {{"feedback", o.faults.crossing_feedback}, {"optimal", o.faults.crossing_optimal}}}};
}

}  // namespace

StudyReport study_projection(const StudyOptions& options) {
  const std::size_t samples = options.samples > 0 ? options.samples : kProjectionSamples;
  const std::size_t checked = std::min(samples, options.checked > 0           ? options.checked
                                                : samples >= kLargeProjection ? kCheckedOfLargeProjection
                                                                              : kProjectionsChecked);
  StudyReport report;
  report.figures = nlohmann::ordered_json::array();
  std::vector<SvgPlot> plots;
  const double runs = static_cast<double>(std::size(kCases) * kSeeds);
  double done = 0;
  for (const Case& c : kCases) {
    for (std::size_t k = 0; k < kSeeds; ++k) {
      const std::uint64_t seed = options.seed + k;
      const Outcome o =
          run_case(c, seed, samples, checked, [&](double share) { options.report((done + share) / runs); });
      done += 1;
      report.text += tables(c, seed, o);
      report.figures.push_back(figures(c, seed, o));
      if (k == 0) plots.push_back(plot_case(c, o));
    }
  }
  report.files.push_back({"projection.svg", svg_page(plots)});
  return report;
}

}  // namespace hotblade::pipeline::study
