// What another blade length, another extension beyond the block or another tension could take off the
// budget's line of the clamps' errors: clamp_table [NAME]...
//
// Samples and five panels are planned. At each rib the shape in the foam is held, and the blade is continued
// along the same elastica by other lengths beyond the foam's two ends, the same at all ribs of a strip, as
// one blade is: the cut stays as it is, only the clamps' places change. Then the tension along the blade is
// changed too, and the shape in the foam fitted anew, where it stays within a tenth of a millimetre of what
// it was. Prints a Markdown table of the line as planned and the least of it.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "elastica/blade/stability.hpp"
#include "elastica/fit/fit.hpp"
#include "pipeline/plan/motion/blade.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/plan/ribs/rib_fit.hpp"
#include "pipeline/settings/assignments.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/clamp_error.hpp"
#include "robot/blade/blade_section.hpp"
#include "samples/panels.hpp"
#include "samples/sample_surfaces.hpp"

namespace {

namespace fs = std::filesystem;
using namespace hotblade;

constexpr double kNone = std::numeric_limits<double>::infinity();
// Extensions beyond the planned ones: so far apart, and up to so much. Responses are smooth over tens of
// millimetres.
constexpr double kStepMm = 25, kMostMoreMm = 500;
// Tensions added to the planned one, times the squared length in the foam. A circular arc of 2 rad has 0; at
// the largest a bend dies out over a tenth of the length.
constexpr std::array kTensions{-20.0, -10.0, -5.0, -2.0, 0.0, 2.0, 5.0, 10.0, 20.0, 40.0, 70.0, 100.0};
// A shape is the same cut within this: a tenth of the samples' tolerance.
constexpr double kSameCutMm = 0.1;

struct Part {
  std::string name;
  surface::DesignSurface design;
  pipeline::Settings settings;
};

// How a blade is continued beyond what was planned, mm; negative is shorter.
struct More {
  double a = 0, b = 0;
};

// What a strip's blade of one length and extension adds to the budget.
struct Held {
  double clamps_mm = kNone, weight_mm = 0;
  double length_mm = 0;
  [[nodiscard]] double sum_mm() const { return clamps_mm + weight_mm; }
};

struct StripBound {
  Held planned;
  Held clamps;   // the least that the clamps alone may add, of blades of any length
  Held listed;   // the least that clamps and weight add, of the lengths that there are
  Held any;      // of blades of any length
  Held tension;  // of any length and tension
};

// The budget has the largest of its strips' lines.
void take_worse(StripBound& all, const StripBound& strip) {
  for (Held StripBound::*kind : {&StripBound::planned, &StripBound::clamps, &StripBound::listed,
                                 &StripBound::any, &StripBound::tension}) {
    Held& of_all = all.*kind;
    const Held& of_strip = strip.*kind;
    if (of_all.length_mm == 0 || of_strip.sum_mm() > of_all.sum_mm()) of_all = of_strip;
  }
}

// The pose with its clamps moved along its elastica. Only what its clamps' response follows from is right of
// it.
pipeline::BladePose continued(const pipeline::BladePose& pose, const More& more) {
  pipeline::BladePose longer = pose;
  longer.blade = elastica::segment(pose.blade, -more.a, pose.blade.length + more.b);
  longer.foam = {{(*pose.foam)[0] + more.a, (*pose.foam)[1] + more.a}};
  const elastica::CurvePoint end = elastica::point_at(longer.blade, longer.blade.length);
  longer.a.p = pose.frame.point(longer.blade.x, longer.blade.y);
  longer.b.p = pose.frame.point(end.x, end.y);
  return longer;
}

// Whether the blade is stable and within yield, its clamps are clear of the block, and its free parts out of
// what is kept of it.
bool holds(const pipeline::BladePose& pose, const pipeline::Block& block,
           const pipeline::Settings& settings) {
  const double length = pose.blade.length;
  const auto [from, to] = *pose.foam;
  if (from < 0 || to > length) return false;
  if (!(elastica::turns_at_most(pose.blade, length) < pipeline::kMostTurnsRad)) return false;
  const elastica::ElasticaCurve curve(pose.blade);
  if (curve.max_abs_curvature() > robot::max_curvature_per_mm(settings.blade)) return false;
  if (std::min(block.distance_mm(pose.a.p), block.distance_mm(pose.b.p)) < settings.stock.clearance_mm)
    return false;
  if (elastica::stability_margin(curve) < settings.blade.min_margin) return false;
  const pipeline::FreeParts free =
      pipeline::examine_free_parts(pose.blade, from, to, block.seen_from(pose.frame));
  return !free.crosses_itself && free.depth_mm <= pipeline::kFreePartDepthMm;
}

// What the clamps' errors move this blade by. One that is nearly straight keeps to its side, which is the
// least of what it may do.
double response_mm(const pipeline::BladePose& pose, const pipeline::MachineSettings& machine) {
  return pipeline::clamp_error_mm(pose, kNone, machine);
}

// What of a strip its weight's part of the budget follows from.
struct Weight {
  Eigen::Vector3d down{0, 0, -1};  // in the design's frame
  double slope = 0;                // sine of the steepest rib's

  Weight(const pipeline::Strip& strip, const pipeline::StripFacts& facts, const robot::Blade& blade)
      : down(strip.design_to_cell.q.conjugate() * -Eigen::Vector3d::UnitZ()) {
    const double by_droop_mm = facts.droop_error_mm - 0.5 * blade.width_mm * facts.motion.twist_rad;
    if (facts.motion.droop_mm > 0) slope = std::clamp(by_droop_mm / facts.motion.droop_mm, 0.0, 1.0);
  }

  // What is not known of a blade's sag; none is known of a blade that tips over.
  [[nodiscard]] double unknown_mm(const pipeline::BladePose& pose, const robot::Blade& blade) const {
    const pipeline::Frame& f = pose.frame;
    const robot::BladeSag sag =
        robot::blade_sag(pose.blade, blade, {down.dot(f.x), down.dot(f.y), down.dot(f.normal())},
                         (*pose.foam)[0], (*pose.foam)[1]);
    if (!sag.stable) return kNone;
    return robot::kSagUnknownShare *
           (sag.droop_mm * slope + 0.5 * blade.width_mm * sag.twist_rad + sag.in_plane_mm);
  }
};

constexpr int kPlaces = 25;
using Offsets = Eigen::Matrix<double, kPlaces, 1>;
using Shape = Eigen::Matrix<double, 5, 1>;  // x, y, theta, kappa, tension across

elastica::MidState shaped(const Shape& shape, double tension, double length) {
  return {shape[0], shape[1], shape[2], shape[3], tension, shape[4], length};
}

// How far a shape lies from another across it, at even arc lengths.
Offsets offsets(const elastica::MidState& mid, const std::vector<elastica::CurvePoint>& from) {
  const auto points = elastica::sample(elastica::from_mid_state(mid), kPlaces);
  Offsets across;
  for (int i = 0; i < kPlaces; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const Eigen::Vector2d t = from[n].tangent(), d = points[n].position() - from[n].position();
    across[i] = t.x() * d.y() - t.y() * d.x();
  }
  return across;
}

// The pose with more tension along the middle of its foam, its shape there fitted anew with the rest of its
// state (Gauss and Newton); nothing where it does not stay within kSameCutMm.
std::optional<pipeline::BladePose> tensioned(const pipeline::BladePose& pose, double more) {
  if (more == 0) return pose;
  const auto [from, to] = *pose.foam;
  const elastica::Elastica part = elastica::segment(pose.blade, from, to);
  const auto points = elastica::sample(part, kPlaces);
  const elastica::MidState was = elastica::mid_state(part);
  const double tension = was.tension1 - more / (part.length * part.length);
  Shape shape;
  shape << was.x, was.y, was.theta, was.kappa, was.tension2;
  Shape steps;
  const double length = part.length;
  steps << 1e-3, 1e-3, 1e-3 / length, 1e-2 / (length * length), 1e-1 / (length * length * length);
  constexpr int kRounds = 12;
  for (int round = 0; round < kRounds; ++round) {
    const Offsets now = offsets(shaped(shape, tension, length), points);
    Eigen::Matrix<double, kPlaces, 5> by;
    for (int k = 0; k < 5; ++k) {
      Shape up = shape, down = shape;
      up[k] += steps[k];
      down[k] -= steps[k];
      by.col(k) =
          (offsets(shaped(up, tension, length), points) - offsets(shaped(down, tension, length), points)) /
          (2 * steps[k]);
    }
    // What moves no point across the shape, as sliding along a circle, is left as it is.
    constexpr double kMovesNothing = 1e-4;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(kMovesNothing);
    solver.compute(by * steps.asDiagonal());
    shape -= steps.asDiagonal() * solver.solve(now);
    if (!shape.allFinite()) return std::nullopt;
    const elastica::MidState mid = shaped(shape, tension, length);
    if (!(elastica::turns_at_most(elastica::from_mid_state(mid), length) < pipeline::kMostTurnsRad))
      return std::nullopt;
  }
  const elastica::MidState mid = shaped(shape, tension, length);
  if (!(offsets(mid, points).cwiseAbs().maxCoeff() <= kSameCutMm)) return std::nullopt;
  pipeline::BladePose other = pose;
  const elastica::Elastica foam = elastica::from_mid_state(mid);
  other.blade = elastica::segment(foam, -from, pose.blade.length - from);
  return other;
}

// All extensions of one tension: what each comes to at the worst rib.
class Sweep {
 public:
  Sweep(const std::vector<pipeline::BladePose>& poses, const pipeline::Strip& strip, const Weight& weight,
        const pipeline::Settings& settings) {
    double least_a = kNone, least_b = kNone;
    for (const pipeline::BladePose& pose : poses) {
      least_a = std::min(least_a, (*pose.foam)[0]);
      least_b = std::min(least_b, pose.blade.length - (*pose.foam)[1]);
    }
    std::vector<More> tries;
    for (double a = -kStepMm * std::floor(least_a / kStepMm); a <= kMostMoreMm; a += kStepMm) {
      for (double b = -kStepMm * std::floor(least_b / kStepMm); b <= kMostMoreMm; b += kStepMm)
        tries.push_back({a, b});
    }
    tried_.resize(tries.size());
    tbb::parallel_for(std::size_t{0}, tries.size(), [&](std::size_t i) {
      Held held{0, 0, strip.blade_length_mm + tries[i].a + tries[i].b};
      for (const pipeline::BladePose& pose : poses) {
        const pipeline::BladePose longer = continued(pose, tries[i]);
        if (!holds(longer, strip.block, settings)) return;
        held.clamps_mm = std::max(held.clamps_mm, response_mm(longer, settings.machine));
        held.weight_mm = std::max(held.weight_mm, weight.unknown_mm(longer, settings.blade));
      }
      tried_[i] = held;
    });
  }

  [[nodiscard]] Held least_clamps() const {
    return *std::min_element(tried_.begin(), tried_.end(),
                             [](const Held& a, const Held& b) { return a.clamps_mm < b.clamps_mm; });
  }
  // Of clamps and weight; of these lengths where some are said.
  [[nodiscard]] Held least(const std::vector<double>* lengths_mm = nullptr) const {
    Held best;
    for (const Held& held : tried_) {
      const auto near = [&](double mm) { return std::abs(mm - held.length_mm) < 0.5 * kStepMm; };
      if (lengths_mm && std::none_of(lengths_mm->begin(), lengths_mm->end(), near)) continue;
      if (held.sum_mm() < best.sum_mm()) best = held;
    }
    return best;
  }

 private:
  std::vector<Held> tried_;  // without end where no blade holds so
};

StripBound bound_of(const pipeline::Strip& strip, const pipeline::StripFacts& facts,
                    const pipeline::Settings& settings) {
  std::vector<pipeline::BladePose> poses;
  for (const pipeline::BladePose& pose : strip.poses)
    if (pose.rib && pose.foam) poses.push_back(pose);
  const Weight weight(strip, facts, settings.blade);
  const Sweep as_fitted(poses, strip, weight, settings);
  StripBound bound;
  bound.planned = {facts.motion.clamp_error_mm,
                   robot::kSagUnknownShare * (facts.droop_error_mm + facts.motion.in_plane_sag_mm),
                   strip.blade_length_mm};
  double now_mm = 0;
  for (const pipeline::BladePose& pose : poses)
    now_mm = std::max(now_mm, response_mm(pose, settings.machine));
  constexpr double kRounding = 1e-6;
  if (now_mm > (1 + kRounding) * bound.planned.clamps_mm)
    throw std::logic_error(strip.id + ": the planned blade moves by more than its budget says");
  bound.clamps = as_fitted.least_clamps();
  bound.clamps.weight_mm = 0;
  bound.listed = as_fitted.least(&settings.blade.free_lengths_mm);
  bound.any = bound.tension = as_fitted.least();
  for (const double more : kTensions) {
    std::vector<pipeline::BladePose> others;
    for (const pipeline::BladePose& pose : poses) {
      const auto other = tensioned(pose, more);
      if (!other) break;
      others.push_back(*other);
    }
    if (more == 0 || others.size() < poses.size()) continue;
    const Held least = Sweep(others, strip, weight, settings).least();
    if (least.sum_mm() < bound.tension.sum_mm()) bound.tension = least;
  }
  return bound;
}

std::string row(const Part& part) {
  const pipeline::PlanResult plan = pipeline::plan(part.design, part.settings, {});
  if (plan.program.verification.status != pipeline::VerificationStatus::kPassed)
    return fmt::format("| {} | refused |", part.name);
  StripBound all;
  for (std::size_t s = 0; s < plan.strips.size(); ++s)
    take_worse(all, bound_of(plan.program.strips[s], plan.strips[s], part.settings));
  const double sum_mm = pipeline::budget_sum_mm(plan.program.verification.budget_mm);
  const auto text = [](const Held& held) {
    return fmt::format("{:.2f} + {:.2f} ({:.0f})", held.clamps_mm, held.weight_mm, held.length_mm);
  };
  const auto then = [&](const Held& held) {
    const double less_mm = all.planned.sum_mm() - held.sum_mm();
    return fmt::format("{:.2f} (-{:.0f} %)", sum_mm - less_mm, 100 * less_mm / sum_mm);
  };
  return fmt::format("| {} | {:.2f} | {} | {:.2f} ({:.0f}) | {} | {} | {} | {} | {} |", part.name, sum_mm,
                     text(all.planned), all.clamps.clamps_mm, all.clamps.length_mm, text(all.listed),
                     then(all.listed), text(all.any), text(all.tension), then(all.tension));
}

Part sample(const std::string& name) {
  const fs::path samples = fs::path(HOTBLADE_SOURCE_DIR) / "samples";
  const pipeline::Settings settings = pipeline::resolve({{samples / (name + ".toml")}, {}, {}});
  return {name,
          surface::read_obj(samples / (name + ".obj"), {settings.design.units, settings.design.up.front()}),
          settings};
}

Part panel(const samples::Panel& panel) {
  const pipeline::Settings settings = pipeline::with_assignments({}, {"design.units=mm", "design.keep=back"});
  return {panel.name, surface::surface_of(samples::obj_text(panel), panel.name + ".obj", {.units = "mm"}),
          settings};
}

// All samples but the roof, whose 269 strips are alike, and of the panels of seed 1 two classic ones and one
// of each kind of patch.
std::vector<Part> parts(const std::vector<std::string>& names) {
  const auto asked = [&](const std::string& name) {
    return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
  };
  std::vector<Part> parts;
  for (const samples::SampleSurface& surface : samples::sample_surfaces())
    if (surface.name != "roof" && asked(surface.name)) parts.push_back(sample(surface.name));
  constexpr std::array<std::size_t, 5> kChosen{1, 8, 12, 13, 14};
  const std::vector<samples::Panel> panels = samples::panels(1);
  for (const std::size_t i : kChosen)
    if (asked(panels[i].name)) parts.push_back(panel(panels[i]));
  return parts;
}

}  // namespace

int main(int argc, char** argv) {
  std::puts(
      "| part | budget mm | planned: clamps + weight mm (blade mm) | clamps alone, any length | least, "
      "blades "
      "listed | budget then | least, any length | least, any length and tension | budget then "
      "|\n|---|---|---|---|---|---|---|---|---|");
  try {
    for (const Part& part : parts({argv + 1, argv + argc})) {
      std::puts(row(part).c_str());
      std::fflush(stdout);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
