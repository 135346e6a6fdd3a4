// Length and energy of quadratic Beziers against quadrature, tangent curves against dense sampling (Ahn,
// Hoffmann, Rosen 2014; "Quadratic Bezier curve is a parabola").
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

#include "pipeline/study/quadratic_oracle.hpp"
#include "pipeline/study/quadratic_plots.hpp"
#include "pipeline/study/study.hpp"

namespace hotblade::pipeline::study {

namespace {

using elastica::Objective;
using elastica::Quadratic;
using elastica::TangentMinimum;

constexpr std::size_t kQuadraticSamples = 100'000, kQuadraticsChecked = 14'000;
// Points on each component of a locus; a minimum narrower than this is not seen.
constexpr int kLocusSamples = 4000;

struct FormErrors {
  double length = 0, energy = 0;  // relative
};

FormErrors form_errors(const Quadratic& q) {
  const QuadraticIntegrals exact = quadrature(q);
  return {std::abs(elastica::length(q) / exact.length - 1), std::abs(elastica::energy(q) / exact.energy - 1)};
}

struct KindErrors {
  std::size_t count = 0;
  FormErrors largest, mean;
};

// What one tangent problem came to.
struct Compared {
  std::size_t sampled = 0, missed = 0, found = 0;
  bool undercut = false;  // a sample lies below the least minimum
  double tangency = 0;
};

Compared compare(const TangentProblem& p) {
  Compared c;
  const elastica::TangentCurves solved = p.solve();
  c.found = solved.minima.size();
  for (const SampledMinimum& s : sampled_minima(p, kLocusSamples)) {
    ++c.sampled;
    // The same minimum: no higher, and within the samples next to the least one.
    const bool met = std::any_of(solved.minima.begin(), solved.minima.end(), [&](const TangentMinimum& m) {
      return m.value <= s.value * (1 + 1e-9) && (m.curve[1] - s.b1).norm() <= 2 * s.step;
    });
    c.missed += met ? 0 : 1;
    c.undercut = c.undercut || solved.minima.empty() || solved.minima.front().value > s.value * (1 + 1e-9);
  }
  for (const TangentMinimum& m : solved.minima)
    if (m.regular) c.tangency = std::max(c.tangency, tangency_error(p, m));
  return c;
}

struct KindCompared {
  std::size_t problems = 0, sampled = 0, missed = 0, found = 0, undercut = 0;
  double tangency = 0;
};

// First by kind, then length and energy.
using TangentTable = std::array<std::array<KindCompared, 2>, kTangentKinds.size()>;

struct QuadraticResults {
  std::array<KindErrors, kTriangleKinds.size()> forms;
  TangentTable tangent;
};

void compare_forms(QuadraticResults& results, std::size_t samples, std::uint64_t seed,
                   const std::function<void(double)>& progress) {
  std::vector<FormErrors> errors(samples);
  over_blocks(samples, progress, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) errors[i] = form_errors(random_triangle(seed, i));
  });
  for (std::size_t i = 0; i < samples; ++i) {
    KindErrors& kind = results.forms[i % kTriangleKinds.size()];
    ++kind.count;
    kind.largest.length = std::max(kind.largest.length, errors[i].length);
    kind.largest.energy = std::max(kind.largest.energy, errors[i].energy);
    kind.mean.length += errors[i].length;
    kind.mean.energy += errors[i].energy;
  }
  for (KindErrors& kind : results.forms) {
    const double n = static_cast<double>(std::max<std::size_t>(1, kind.count));
    kind.mean = {kind.mean.length / n, kind.mean.energy / n};
  }
}

void compare_tangents(QuadraticResults& results, std::size_t problems, std::uint64_t seed,
                      const std::function<void(double)>& progress) {
  std::vector<Compared> compared(problems);
  over_blocks(problems, progress, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) compared[i] = compare(random_problem(seed, i));
  });
  for (std::size_t i = 0; i < problems; ++i) {
    KindCompared& k = results.tangent[i % kTangentKinds.size()][i / kTangentKinds.size() % 2];
    const Compared& c = compared[i];
    ++k.problems;
    k.sampled += c.sampled;
    k.missed += c.missed;
    k.found += c.found;
    k.undercut += c.undercut ? 1 : 0;
    k.tangency = std::max(k.tangency, c.tangency);
  }
}

std::string text_of(const QuadraticResults& r, std::size_t samples, std::size_t problems) {
  std::string text = fmt::format("{} triangles, relative errors against quadrature in 34 digits\n", samples);
  text += fmt::format("  {:<34}{:>9}{:>14}{:>13}{:>14}{:>13}\n", "", "count", "length, mean", "largest",
                      "energy, mean", "largest");
  for (std::size_t k = 0; k < kTriangleKinds.size(); ++k) {
    const KindErrors& e = r.forms[k];
    text += fmt::format("  {:<34}{:>9}{:>14.1e}{:>13.1e}{:>14.1e}{:>13.1e}\n", kTriangleKinds[k], e.count,
                        e.mean.length, e.largest.length, e.mean.energy, e.largest.energy);
  }
  text += fmt::format("{} tangent problems against {} samples of every component of the locus\n", problems,
                      kLocusSamples);
  text += fmt::format("  {:<40}{:>9}{:>9}{:>9}{:>9}{:>10}{:>12}\n", "", "problems", "minima", "sampled",
                      "missed", "undercut", "tangency");
  for (std::size_t k = 0; k < kTangentKinds.size(); ++k) {
    for (const std::size_t energy : {0u, 1u}) {
      const KindCompared& c = r.tangent[k][energy];
      text += fmt::format("  {:<40}{:>9}{:>9}{:>9}{:>9}{:>10}{:>12.1e}\n",
                          fmt::format("{}, {}", kTangentKinds[k], energy == 0 ? "length" : "energy"),
                          c.problems, c.found, c.sampled, c.missed, c.undercut, c.tangency);
    }
  }
  return text;
}

nlohmann::ordered_json figures_of(const QuadraticResults& r, std::size_t samples, std::size_t problems,
                                  std::uint64_t seed) {
  nlohmann::ordered_json forms = nlohmann::ordered_json::array(), tangent = forms;
  for (std::size_t k = 0; k < kTriangleKinds.size(); ++k) {
    const KindErrors& e = r.forms[k];
    forms.push_back({{"kind", kTriangleKinds[k]},
                     {"count", e.count},
                     {"length", {{"mean", e.mean.length}, {"max", e.largest.length}}},
                     {"energy", {{"mean", e.mean.energy}, {"max", e.largest.energy}}}});
  }
  for (std::size_t k = 0; k < kTangentKinds.size(); ++k) {
    for (const std::size_t energy : {0u, 1u}) {
      const KindCompared& c = r.tangent[k][energy];
      tangent.push_back({{"kind", kTangentKinds[k]},
                         {"minimise", energy == 0 ? "length" : "energy"},
                         {"problems", c.problems},
                         {"minima", c.found},
                         {"sampled", c.sampled},
                         {"missed", c.missed},
                         {"undercut", c.undercut},
                         {"tangency", c.tangency}});
    }
  }
  return {{"seed", seed},
          {"samples", samples},
          {"relative_errors", forms},
          {"checked", problems},
          {"tangent", tangent}};
}

double thread_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Middle control points with the value of the best solution.
std::vector<Eigen::Vector2d> level_set(const TangentProblem& p, const elastica::TangentCurves& solved) {
  constexpr int kPointsOfSet = 360;
  if (solved.minima.empty()) return {};
  const double value = solved.minima[solved.best].value;
  return p.objective == Objective::kLength ? elastica::length_level_set(p.b0, p.b2, value, kPointsOfSet)
                                           : elastica::energy_level_set(p.b0, p.b2, value, kPointsOfSet);
}

// Solutions a second of one core, of lines or circles of all cases by turns; with the level set through each,
// too.
double rate(bool circle, Objective objective, bool level_sets) {
  constexpr std::uint64_t kSeed = 1;
  constexpr double kSeconds = 0.02;
  const double start = thread_seconds();
  double solved = 0, spent = 0;
  for (std::uint64_t i = 0; spent < kSeconds; ++i) {
    TangentProblem p = random_problem(kSeed, i);
    if (p.circle != circle) continue;
    p.objective = objective;
    const elastica::TangentCurves curves = p.solve();
    if (level_sets) (void)level_set(p, curves);
    solved += 1;
    spent = thread_seconds() - start;
  }
  return solved / spent;
}

std::vector<std::string> rates() {
  struct Rate {
    const char* name;
    bool circle;
    Objective objective;
    int paper, paper_with_sets;
  };
  constexpr Rate kRates[] = {{"least length, line", false, Objective::kLength, 2000, 340},
                             {"least length, circle", true, Objective::kLength, 1400, 300},
                             {"least energy, line", false, Objective::kEnergy, 2000, 300},
                             {"least energy, circle", true, Objective::kEnergy, 1290, 275}};
  std::vector<std::string> lines;
  for (const Rate& t : kRates) {
    lines.push_back(fmt::format(
        "{}: {:.0f} a second on one core (paper: {}), {:.0f} with a level set of 360 points (paper: {})",
        t.name, rate(t.circle, t.objective, false), t.paper, rate(t.circle, t.objective, true),
        t.paper_with_sets));
  }
  return lines;
}

}  // namespace

StudyReport study_quadratic(const StudyOptions& options) {
  const std::size_t samples = options.samples > 0 ? options.samples : kQuadraticSamples;
  const std::size_t problems = options.checked > 0 ? options.checked : kQuadraticsChecked;
  QuadraticResults r;
  compare_forms(r, samples, options.seed, [&](double share) { options.report(0.7 * share); });
  compare_tangents(r, problems, options.seed, [&](double share) { options.report(0.7 + 0.3 * share); });
  return {text_of(r, samples, problems),
          figures_of(r, samples, problems, options.seed),
          {{"level-sets.svg", level_set_figure()}, {"tangent.svg", tangent_figure()}},
          rates()};
}

}  // namespace hotblade::pipeline::study
