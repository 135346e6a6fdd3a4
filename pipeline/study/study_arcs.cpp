// Elastica as circular arcs of the same length, and the theorems behind (Kurnosenko 2018).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "elastica/arcs/arcs_reach.hpp"
#include "pipeline/study/arc_measures.hpp"
#include "pipeline/study/arc_plots.hpp"
#include "pipeline/study/study.hpp"
#include "pipeline/study/svg_plot.hpp"

namespace hotblade::pipeline::study {

namespace {

using elastica::Arc;
using elastica::ArcFit;
using elastica::ArcOrder;
using elastica::Elastica;
using elastica::ElasticaCurve;

constexpr std::size_t kArcSamples = 2000, kArcsChecked = 20'000;
constexpr std::array kTolerances{1.0, 1e-1, 1e-2, 1e-3, 1e-4};  // mm
constexpr std::size_t kToleranceCount = kTolerances.size();
// Rounding of a place on a curve, of its length: the arcs are chained over hundreds of joints.
constexpr double kRounding = 1e-12;

// One fit against its curve.
struct Measured {
  std::size_t arcs = 0;
  double length_off = 0;            // of the curve's length
  double deviation = 0, bound = 0;  // mm
  bool above = false;               // the deviation is above the bound
};

Measured measure(const ElasticaCurve& curve, const ArcFit& fit) {
  const double length = curve.elastica().length;
  Measured m{fit.arcs.size(), std::abs(fit.length / length - 1), 0, fit.error_bound, false};
  m.deviation = deviation(curve, 0, fit.arcs, static_cast<int>(400 + 8 * fit.arcs.size()));
  m.above = m.deviation > m.bound + kRounding * length;
  return m;
}

struct Fitted {
  std::array<Measured, kToleranceCount> biarcs, triarcs;
  std::array<BisectedArcs, kToleranceCount> kept, plain;
  double length = 0;
  double bound_order = 0, deviation_order = 0;  // 0: lost in rounding
};

// Largest bound and deviation of the biarcs when every spiral is cut into equal parts.
Measured equal_parts(const ElasticaCurve& curve, const std::vector<double>& breaks, int parts) {
  Measured worst;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double step = (breaks[k + 1] - breaks[k]) / parts;
    for (int i = 0; i < parts; ++i) {
      const double from = breaks[k] + i * step;
      const auto arcs = spiral_arcs({curve.at(from), curve.at(from + step), step}, ArcOrder::kBiarc);
      if (!arcs) continue;
      worst.bound = std::max(worst.bound, arcs->error_bound);
      worst.deviation = std::max(worst.deviation, deviation(curve, from, arcs->arcs, 17));
    }
  }
  return worst;
}

Fitted fit_one(const Elastica& e) {
  constexpr int kParts = 32;
  const ElasticaCurve curve(e);
  const std::vector<double> breaks = spiral_breaks(e);
  Fitted f;
  f.length = e.length;
  for (std::size_t k = 0; k < kToleranceCount; ++k) {
    f.biarcs[k] = measure(curve, fit_arcs(e, kTolerances[k], ArcOrder::kBiarc));
    f.triarcs[k] = measure(curve, fit_arcs(e, kTolerances[k], ArcOrder::kTriarc));
    f.kept[k] = bisected_arcs(curve, breaks, kTolerances[k], Joint::kSameLength);
    f.plain[k] = bisected_arcs(curve, breaks, kTolerances[k], Joint::kEqualChords);
  }
  const Measured coarse = equal_parts(curve, breaks, kParts), fine = equal_parts(curve, breaks, 2 * kParts);
  if (fine.deviation > 1e3 * kRounding * e.length) {
    f.bound_order = std::log2(coarse.bound / fine.bound);
    f.deviation_order = std::log2(coarse.deviation / fine.deviation);
  }
  return f;
}

// One tolerance over all curves.
struct Row {
  double biarcs = 0, triarcs = 0, kept = 0, plain = 0;  // mean numbers of arcs
  double length_off = 0, plain_length_off = 0;          // largest, of the length
  std::size_t above = 0;
  double largest_share = 0, mean_share = 0;  // of the bound that the deviation takes
};

Row row_of(const std::vector<Fitted>& fits, std::size_t k) {
  Row r;
  const double n = static_cast<double>(fits.size());
  for (const Fitted& f : fits) {
    r.biarcs += static_cast<double>(f.biarcs[k].arcs) / n;
    r.triarcs += static_cast<double>(f.triarcs[k].arcs) / n;
    r.kept += static_cast<double>(f.kept[k].arcs) / n;
    r.plain += static_cast<double>(f.plain[k].arcs) / n;
    r.plain_length_off = std::max(r.plain_length_off, std::abs(f.plain[k].length / f.length - 1));
    for (const Measured& m : {f.biarcs[k], f.triarcs[k]}) {
      r.length_off = std::max(r.length_off, m.length_off);
      r.above += m.above ? 1 : 0;
      const double share = m.bound > 1e3 * kRounding * f.length ? m.deviation / m.bound : 0;
      r.largest_share = std::max(r.largest_share, share);
      r.mean_share += share / (2 * n);
    }
  }
  return r;
}

// Theorem 1, the bilens, inequalities (15) and the reach, on one random spiral.
struct Tried {
  bool spiral = false;  // no circular arc to rounding
  bool theorem = true, in_bilens = true, inequalities = true, reached = true;
  double place = 0;  // of the length between the least and the greatest of (15), 0 to 1
};

Tried try_spiral(std::uint64_t seed, std::uint64_t index) {
  constexpr double kLength = 1.4;  // turns by up to 2.8
  CurveRandom random(seed, index);
  const double sign = index % 2 == 0 ? 1 : -1;
  const double k1 = sign * random.between(0, 2), k2 = sign * random.between(0, 2);
  const std::vector<Arc> spiral = random_spiral(random, k1, k2, kLength);
  elastica::CurvePoint end = point_at(spiral.back(), spiral.back().length);
  end.kappa = k2;
  const elastica::SpiralEnds ends{{0, 0, 0, k1}, end, kLength};
  Tried t;
  t.reached = elastica::spiral_reaches(k1, k2, kLength, end.position());
  const auto family = elastica::BiarcFamily::between(ends.a, ends.b);
  if (!family) return t;
  const auto outer = convex_length_range(*family), inner = convex_length_range(*family, k1, k2);
  if (!outer || !inner) return t;
  t.spiral = true;
  const double slack = kRounding * kLength;
  t.inequalities = outer->least <= inner->least + slack && inner->least <= kLength + slack &&
                   kLength <= inner->greatest + slack && inner->greatest <= outer->greatest + slack;
  t.place = (kLength - inner->least) / (inner->greatest - inner->least);
  const auto biarc = spiral_arcs(ends, ArcOrder::kBiarc);
  if (!biarc) {
    t.theorem = false;
    return t;
  }
  const double rises = k2 > k1 ? 1 : -1, q1 = biarc->arcs.front().kappa, q2 = biarc->arcs.back().kappa;
  t.theorem = rises * (q1 - k1) >= -1e-9 && rises * (q2 - q1) >= -1e-9 && rises * (k2 - q2) >= -1e-9;
  for (const Arc& arc : spiral) {
    double nearest = std::numeric_limits<double>::infinity();
    const Eigen::Vector2d middle = point_at(arc, 0.5 * arc.length).position();
    for (const Arc& one : biarc->arcs) nearest = std::min(nearest, distance_to(one, middle));
    t.in_bilens = t.in_bilens && nearest <= biarc->error_bound + slack;
  }
  return t;
}

struct Theorems {
  std::size_t spirals = 0, theorem = 0, bilens = 0, inequalities = 0, reach = 0;  // broken
  double least_place = 1, greatest_place = 0;
};

Theorems theorems(const std::vector<Tried>& tried) {
  Theorems t;
  for (const Tried& one : tried) {
    t.reach += one.reached ? 0 : 1;
    if (!one.spiral) continue;
    ++t.spirals;
    t.theorem += one.theorem ? 0 : 1;
    t.bilens += one.in_bilens ? 0 : 1;
    t.inequalities += one.inequalities ? 0 : 1;
    t.least_place = std::min(t.least_place, one.place);
    t.greatest_place = std::max(t.greatest_place, one.place);
  }
  return t;
}

// Mean of what is not lost in rounding.
double mean_order(const std::vector<Fitted>& fits, double Fitted::*order) {
  double sum = 0, n = 0;
  for (const Fitted& f : fits) {
    if (f.*order == 0) continue;
    sum += f.*order;
    n += 1;
  }
  return n > 0 ? sum / n : 0;
}

struct ArcResults {
  std::array<Row, kToleranceCount> rows;
  double bound_order = 0, deviation_order = 0;
  Theorems theorems;
  std::vector<double> contacts, far_contacts;  // in pi
};

std::vector<double> contacts(double k1) {
  const elastica::Oval oval{{3.5, 3.2, 4.3, 4.0}, {k1, 0.80, 0.07, 0.85}};  // equation 20
  std::vector<double> list;
  for (const elastica::OvalContact& c : oval_contacts(oval)) list.push_back(c.mu / std::numbers::pi);
  return list;
}

std::string text_of(const ArcResults& r, std::size_t samples) {
  std::string text = fmt::format("{} random elastica, 200 to 1400 mm long; mean numbers of arcs\n", samples);
  text +=
      fmt::format("  {:>9}{:>9}{:>9}{:>11}{:>11}{:>11}{:>12}{:>9}{:>9}{:>7}\n", "tolerance", "biarcs",
                  "triarcs", "halved", "halved", "length off", "length off", "of bound", "of bound", "above");
  text += fmt::format("  {:>9}{:>9}{:>9}{:>11}{:>11}{:>11}{:>12}{:>9}{:>9}{:>7}\n", "mm", "", "",
                      "length kept", "plain", "kept", "plain", "mean", "largest", "bound");
  for (std::size_t k = 0; k < kToleranceCount; ++k) {
    const Row& row = r.rows[k];
    text += fmt::format("  {:>9g}{:>9.2f}{:>9.2f}{:>11.2f}{:>11.2f}{:>11.1e}{:>12.1e}{:>9.3f}{:>9.3f}{:>7}\n",
                        kTolerances[k], row.biarcs, row.triarcs, row.kept, row.plain, row.length_off,
                        row.plain_length_off, row.mean_share, row.largest_share, row.above);
  }
  text += fmt::format("  order of convergence: bound {:.3f}, deviation {:.3f} (theory: 3)\n", r.bound_order,
                      r.deviation_order);
  const Theorems& t = r.theorems;
  text += fmt::format(
      "{} random spirals of up to 10 steps\n  broken: theorem 1 {}, bilens {}, inequalities (15) {}, reach "
      "{}\n"
      "  length between the bounds of (15): {:.5f} to {:.5f} of their distance\n",
      t.spirals, t.theorem, t.bilens, t.inequalities, t.reach, t.least_place, t.greatest_place);
  const auto list = [](const std::vector<double>& values) {
    std::string words;
    for (const double v : values) words += fmt::format("{}{:.5f} pi", words.empty() ? "" : ", ", v);
    return words.empty() ? std::string("none") : words;
  };
  text += fmt::format("oval (20): contacts at {} (paper: 0.79 pi, 1.07 pi)\n", list(r.contacts));
  text += fmt::format("  with k1 = 0.42: {} (paper: none)\n", list(r.far_contacts));
  return text;
}

nlohmann::ordered_json figures_of(const ArcResults& r, std::size_t samples, std::uint64_t seed) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < kToleranceCount; ++k) {
    const Row& row = r.rows[k];
    rows.push_back({{"tolerance_mm", kTolerances[k]},
                    {"biarcs", row.biarcs},
                    {"triarcs", row.triarcs},
                    {"halved_length_kept", row.kept},
                    {"halved_plain", row.plain},
                    {"length_off", row.length_off},
                    {"plain_length_off", row.plain_length_off},
                    {"mean_share_of_bound", row.mean_share},
                    {"largest_share_of_bound", row.largest_share},
                    {"above_bound", row.above}});
  }
  const Theorems& t = r.theorems;
  return {{"seed", seed},
          {"samples", samples},
          {"fits", rows},
          {"order_of_bound", r.bound_order},
          {"order_of_deviation", r.deviation_order},
          {"spirals", t.spirals},
          {"broken",
           {{"theorem_1", t.theorem},
            {"bilens", t.bilens},
            {"inequalities_15", t.inequalities},
            {"reach", t.reach}}},
          {"length_between_bounds", {t.least_place, t.greatest_place}},
          {"oval_contacts_pi", r.contacts},
          {"paper_oval_contacts_pi", {0.79, 1.07}},
          {"oval_contacts_pi_k1_0.42", r.far_contacts}};
}

std::string convergence_figure(const std::array<Row, kToleranceCount>& rows) {
  SvgPlot plot(
      {"Arcs of an elastica", "log10 of tolerance in mm", "log10 of number of arcs", -4.2, 0.2, 0, 3.2});
  const auto line = [&](double Row::*value, const char* colour, const char* name) {
    std::vector<Eigen::Vector2d> points;
    for (std::size_t k = 0; k < kToleranceCount; ++k)
      points.emplace_back(std::log10(kTolerances[k]), std::log10(rows[k].*value));
    plot.line(points, colour, 1.5, name);
    plot.points(points, colour, 7, "");
  };
  line(&Row::biarcs, "#2c7fb8", "biarcs, by the bound");
  line(&Row::triarcs, "#d7301f", "triarcs, by the bound");
  line(&Row::kept, "#41ab5d", "biarcs, halved, length kept");
  line(&Row::plain, "#888888", "plain biarcs, halved");
  const SvgPlot plots[] = {plot};
  return svg_page(plots);
}

}  // namespace

StudyReport study_arcs(const StudyOptions& options) {
  const std::size_t samples = options.samples > 0 ? options.samples : kArcSamples;
  const std::size_t checked = options.checked > 0 ? options.checked : kArcsChecked;
  const std::uint64_t seed = options.seed;
  std::vector<Fitted> fits(samples);
  over_blocks(
      samples, [&](double share) { options.report(0.8 * share); },
      [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) fits[i] = fit_one(random_elastica(seed, i));
      });
  std::vector<Tried> tried(checked);
  over_blocks(
      checked, [&](double share) { options.report(0.8 + 0.1 * share); },
      [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) tried[i] = try_spiral(seed, i);
      });
  ArcResults r;
  for (std::size_t k = 0; k < kToleranceCount; ++k) r.rows[k] = row_of(fits, k);
  r.bound_order = mean_order(fits, &Fitted::bound_order);
  r.deviation_order = mean_order(fits, &Fitted::deviation_order);
  r.theorems = theorems(tried);
  r.contacts = contacts(0.25);
  r.far_contacts = contacts(0.42);
  return {text_of(r, samples),
          figures_of(r, samples, seed),
          {{"arcs.svg", arc_figure()},
           {"reach.svg", reach_figure(seed)},
           {"convergence.svg", convergence_figure(r.rows)}}};
}

}  // namespace hotblade::pipeline::study
