#include "pipeline/plan/plan.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>

#include "pipeline/plan/forecast.hpp"
#include "pipeline/plan/plan_progress.hpp"
#include "pipeline/plan/planned_ribs.hpp"
#include "pipeline/plan/stopwatch.hpp"
#include "pipeline/plan/strips/strips.hpp"
#include "pipeline/plan/sweep/sweep_directions.hpp"
#include "pipeline/plan/sweep/sweep_search.hpp"
#include "pipeline/program/version.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/foam_share.hpp"
#include "pipeline/verify/rib_measures.hpp"
#include "pipeline/verify/verdict.hpp"
#include "robot/blade/blade_section.hpp"
#include "surface/slice/slice.hpp"

namespace hotblade::pipeline {

namespace {

constexpr int kMaxRefinements = 3;

// Of an attempt, what is done when its ribs are fitted, when its strips are posed, and when it is verified.
constexpr double kFitShare = 0.1, kPoseShare = 0.3, kVerifyShare = 0.9;

StripFacts facts_of(const PosedStrip& posed, const Settings& settings) {
  const StripPlan& plan = posed.strip;
  StripFacts f;
  f.id = plan.id;
  f.ribs = plan.ribs.size();
  f.blade_length_mm = plan.blade_length_mm;
  f.motion = posed.motion.facts;
  f.smallest_margin = std::min(plan.smallest_margin, f.motion.smallest_margin);
  double steepest = 0;
  for (const RibFit& rib : plan.ribs) {
    f.projected_ribs += rib.projected ? 1 : 0;
    f.worst_fit_mm = std::max(f.worst_fit_mm, rib.deviation_mm);
    f.worst_bezier_mm = std::max(f.worst_bezier_mm, rib.bezier_deviation_mm);
    f.largest_lambda_residual = std::max(f.largest_lambda_residual, rib.lambda_residual);
    steepest = std::max(steepest, rib.max_slope_rad);
  }
  if (plan.separate) {
    double own = 0;
    for (const RibFit& rib : plan.separate->ribs) own = std::max(own, rib.deviation_mm);
    f.joint_fit_mm = std::max(0.0, f.worst_fit_mm - own);
  }
  f.joint = plan.joint;
  f.seam = plan.seam_before;
  // The twist tilts the section, whose edges move by half its width.
  f.droop_error_mm =
      f.motion.droop_mm * std::sin(steepest) + 0.5 * settings.blade.width_mm * f.motion.twist_rad;
  f.stock_volume_mm3 = plan.block.size_mm.prod();
  f.plinth_mm = plan.block.height_above_table_mm(plan.design_to_cell);
  f.plane_turn_rad =
      plan.planes.angle(plan.ribs.back().offset_mm) - plan.planes.angle(plan.ribs.front().offset_mm);
  return f;
}

PlannedStrip planned_strip(PosedStrip posed, const Settings& settings) {
  PlannedStrip planned;
  planned.facts = facts_of(posed, settings);
  planned.refusals = std::move(posed.motion.refusals);
  planned.warnings = std::move(posed.motion.warnings);
  planned.strip = make_strip(posed.strip, std::move(posed.motion.poses), settings.design.tolerance_mm);
  planned.facts.foam_kept_share = foam_kept_share(planned.strip);
  return planned;
}

DesignData design_data(const surface::DesignSurface& design, const Settings& settings) {
  return {design.file_name,
          design.sha256,
          design.units,
          design.scale_to_mm,
          design.up,
          settings.design.keep,
          design.health.vertices,
          design.health.triangles,
          design.health.bbox_mm};
}

void check_interrupt(const PlanHooks& hooks) {
  if (hooks.stop()) throw Error(ErrorKind::kInterrupted, "interrupted: nothing was written");
}

// A strip that its blade would not get through as planned, by a shorter one where that one does.
PosedStrip posed_shorter(PosedStrip posed, const Settings& settings) {
  std::optional<StripPlan> next;
  while (!posed.motion.refusals.empty() &&
         (next = with_shorter_blade(next ? *next : posed.strip, settings))) {
    BladeMotion motion = move_blade(*next, settings);
    if (motion.refusals.size() < posed.motion.refusals.size()) posed = {*next, std::move(motion)};
  }
  return posed;
}

// A strip whose ribs were solved together may bring the blade nearer to a snap on its way from the flat arc:
// then each rib's own fit is posed as well, and the safer of the two is taken.
PosedStrip pose_strip(const StripPlan& strip, const Settings& settings) {
  constexpr double kFarFromSnap = 10;  // times the smallest margin allowed
  PosedStrip posed{strip, move_blade(strip, settings)};
  const bool far = posed.motion.facts.smallest_margin >= kFarFromSnap * settings.blade.min_margin;
  if (!strip.separate || (posed.motion.refusals.empty() && far)) return posed;
  StripPlan separate = *strip.separate;
  separate.id = strip.id;
  separate.seam_before = strip.seam_before;
  BladeMotion motion = move_blade(separate, settings);
  const std::size_t was = posed.motion.refusals.size(), is = motion.refusals.size();
  if (is < was || (is == was && motion.facts.smallest_margin > posed.motion.facts.smallest_margin)) {
    return {std::move(separate), std::move(motion)};
  }
  return posed;
}

// Strips are posed side by side and handed over in their order.
void pose_strips(const StripLayout& layout, const Settings& settings, const PlanHooks& hooks,
                 PlanResult& result) {
  const std::size_t count = layout.strips.size();
  std::vector<PlannedStrip> planned(count);
  std::mutex telling;
  std::size_t told = 0;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    check_interrupt(hooks);
    PosedStrip posed = posed_shorter(pose_strip(layout.strips[i], settings), settings);
    posed.strip.design_to_cell.p.z() += posed.motion.raise_mm;
    planned[i] = planned_strip(std::move(posed), settings);
    const std::scoped_lock lock(telling);
    const double posed_share = static_cast<double>(++told) / static_cast<double>(count);
    hooks.progress("pose", kPoseShare + posed_share * (kVerifyShare - kPoseShare));
  });
  for (PlannedStrip& d : planned) {
    result.program.strips.push_back(std::move(d.strip));
    result.strips.push_back(std::move(d.facts));
    std::move(d.refusals.begin(), d.refusals.end(), std::back_inserter(result.refusals));
    std::move(d.warnings.begin(), d.warnings.end(), std::back_inserter(result.warnings));
  }
}

// Bezier against elastica, all ribs of the plan in one batch.
void measure_ribs(Program& program, gpu::Backend backend) {
  const RibMeasures measures = measured_ribs(program, backend);
  auto measure = measures.ribs.begin();
  for (Strip& strip : program.strips) {
    for (Rib& rib : strip.ribs) {
      if (!std::isfinite(measure->h1)) throw std::logic_error(rib.id + ": a rib that cannot be measured");
      rib.l2 = measure->l2;
      rib.h1 = measure->h1;
      rib.hausdorff_mm = measure->hausdorff_mm;
      ++measure;
    }
  }
}

// Poses the strips of a layout, and measures what they cut.
void pose_and_verify(const StripLayout& layout, const surface::DesignSurface& design,
                     const Settings& settings, const PlanHooks& hooks, Stopwatch& watch, PlanResult& result) {
  pose_strips(layout, settings, hooks, result);
  watch.lap("pose");
  measure_ribs(result.program, hooks.backend);
  hooks.progress("verify", kVerifyShare);
  check_interrupt(hooks);
  VerifyOptions verify_options;
  verify_options.tolerance_mm = settings.design.tolerance_mm;
  verify_options.max_uncut_share = settings.design.max_uncut_share;
  verify_options.backend = hooks.backend;
  verify_options.min_margin = settings.blade.min_margin;
  result.verification = verify(result.program, design, verify_options);
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    result.strips[i].deviation_max_mm = result.verification.strip_max_mm[i];
  }
  watch.lap("verify");
}

// Slices, fits, poses and verifies at one rib spacing. Whether every rib found its strip and blade: what is
// refused then is refused by the motion.
bool plan_once(const surface::DesignSurface& design, const Settings& settings, const PlanHooks& hooks,
               Stopwatch& watch, PlanResult& result) {
  result.program.strips.clear();
  result.strips.clear();
  result.warnings.clear();
  surface::SliceOptions options;
  options.normal = result.ranking.front().normal;
  options.fan = result.ranking.front().fan;
  options.spacing_mm = result.spacing_mm;
  options.keep_tips = true;
  const surface::RibGraph graph = slice(design, options);
  result.warnings = graph.warnings;
  watch.lap("slice");
  hooks.progress("fit", kFitShare);
  check_interrupt(hooks);
  const StripLayout layout = lay_out_strips(make_targets(graph, settings), settings, kMostMoreStrips, [&] {
    check_interrupt(hooks);
    hooks.progress("fit", kFitShare);
  });
  result.refusals = layout.refusals;
  result.warnings.insert(result.warnings.end(), layout.warnings.begin(), layout.warnings.end());
  watch.lap("fit");
  pose_and_verify(layout, design, settings, hooks, watch, result);
  return layout.refusals.empty();
}

bool moves(const PlanResult& result) {
  return result.refusals.empty() && result.verification.holds();
}

// Where a strip that was laid out cannot be cut, closer fits make other strips: their blades bend otherwise,
// or more of them share the ribs. Taken when all of them can be cut.
void plan_with_closer_fits(const surface::DesignSurface& design, Settings& settings, const PlanHooks& hooks,
                           Stopwatch& watch, PlanResult& result) {
  constexpr int kTries = 2;
  constexpr double kCloser = 0.7;
  Settings closer = settings;
  for (int i = 0; i < kTries; ++i) {
    closer.fit.deviation_share *= kCloser;
    PlanResult other = result;
    if (!plan_once(design, closer, hooks, watch, other)) return;
    if (!moves(other)) continue;
    result = std::move(other);
    settings = closer;
    return;
  }
}

// Limits of the whole: the deviation and the area left out.
void judge(const Settings& settings, PlanResult& result) {
  const VerifyReport& v = result.verification;
  if (result.program.strips.empty() && result.refusals.empty()) {
    result.refusals.push_back({"design", "", Limit::kStrips, 0, 1});
  }
  for (const StripFacts& f : result.strips) {
    const double together =
        f.deviation_max_mm + robot::kSagUnknownShare * (f.droop_error_mm + f.motion.in_plane_sag_mm);
    if (together <= settings.design.tolerance_mm || f.deviation_max_mm > settings.design.tolerance_mm)
      continue;
    result.refusals.push_back({f.id, "", Limit::kDeviationWithSag, together, settings.design.tolerance_mm});
  }
  for (std::size_t i = 0; i < v.branches.size(); ++i) {
    if (!v.branches[i].held())
      result.refusals.push_back(branch_refusal(result.program.strips[i], v.branches[i]));
  }
  for (const FarBezier& bezier : v.ribs.far) result.refusals.push_back(refusal_of(bezier));
  if (v.deviation.max > settings.design.tolerance_mm) {
    const auto worst = std::max_element(v.strip_max_mm.begin(), v.strip_max_mm.end());
    const std::string strip =
        worst == v.strip_max_mm.end()
            ? "design"
            : result.strips[static_cast<std::size_t>(worst - v.strip_max_mm.begin())].id;
    const Eigen::Vector3d& at = v.deviation.at;
    result.refusals.push_back({fmt::format("{} at ({:.1f}, {:.1f}, {:.1f})", strip, at.x(), at.y(), at.z()),
                               "", Limit::kDeviation, v.deviation.max, settings.design.tolerance_mm});
    result.refusals.back().capped = v.capped;
    result.refusals.back().at = at;
  }
  if (v.uncut_share() > settings.design.max_uncut_share) {
    result.refusals.push_back(
        {"design", "", Limit::kUncutShare, 100 * v.uncut_share(), 100 * settings.design.max_uncut_share});
  }
}

// Ribs follow the facets of the file, not the surface that they stand for.
void warn_of_facets(const surface::DesignSurface& design, const Settings& settings, PlanResult& result) {
  const double chord = mesh_chord_mm(design.mesh);
  const double allowed = settings.fit.deviation_share * settings.design.tolerance_mm;
  if (chord <= allowed) return;
  result.warnings.push_back(
      fmt::format("design: height of the facets' chords ({:.3g} mm, limit {:.3g} mm): the cut follows its "
                  "facets, not the surface that they stand for",
                  chord, allowed));
}

PoseErrors pose_errors(const std::vector<StripFacts>& strips) {
  PoseErrors share;
  for (const StripFacts& f : strips) {
    share.droop_mm = std::max(share.droop_mm, robot::kSagUnknownShare * f.droop_error_mm);
    share.in_plane_mm = std::max(share.in_plane_mm, robot::kSagUnknownShare * f.motion.in_plane_sag_mm);
    share.clamp_mm = std::max(share.clamp_mm, f.motion.clamp_error_mm);
    share.joint_fit_mm = std::max(share.joint_fit_mm, f.joint_fit_mm);
    share.off_plane_mm = std::max(share.off_plane_mm, f.motion.off_plane_mm);
  }
  return share;
}

// Errors that no measurement of the plan can see may be over the tolerance together with those it can.
void judge_budget(const Settings& settings, PlanResult& result) {
  if (result.verification.cut_samples == 0) return;
  const Verdict verdict = verdict_of(result.program);
  if (!verdict.over_budget()) return;
  if (settings.design.over_budget == OverBudget::kWarn) {
    result.warnings.push_back("design: " + budget_text(verdict));
    return;
  }
  result.refusals.push_back(
      {"design", "", Limit::kBudget, verdict.budget_mm, verdict.tolerance_mm, needed_text(verdict)});
  result.program.verification.status = VerificationStatus::kRefused;
}

// Plans with one of the ranked directions, which is put first in the ranking.
void plan_along(std::size_t direction, const surface::DesignSurface& design, const Settings& settings,
                const PlanHooks& hooks, Stopwatch& watch, PlanResult& result) {
  const auto first = result.ranking.begin();
  std::rotate(first, first + static_cast<std::ptrdiff_t>(direction),
              first + static_cast<std::ptrdiff_t>(direction) + 1);
  result.refinements = 0;
  result.spacing_mm = settings.slice.spacing_mm;
  Settings taken = settings;
  if (plan_once(design, taken, hooks, watch, result) && !moves(result))
    plan_with_closer_fits(design, taken, hooks, watch, result);
  // Closer ribs help only against what happens between ribs.
  while (result.refinements < kMaxRefinements && result.refusals.empty() && !result.program.strips.empty() &&
         result.verification.deviation.max > settings.design.tolerance_mm) {
    ++result.refinements;
    result.spacing_mm /= 2;
    plan_once(design, taken, hooks, watch, result);
  }
  judge(settings, result);
}

// A coarse plan does not see all that may stand against a direction: when the best one is refused, the next
// best ones are planned, and the first that passes is taken.
void try_others(const surface::DesignSurface& design, const Settings& settings, const PlanHooks& hooks,
                Stopwatch& watch, PlanResult& result) {
  constexpr int kMostTries = 3;
  if (settings.slice.direction || settings.slice.fan_axis || result.refusals.empty()) return;
  PlanResult other = result;
  for (int tries = 1; tries < kMostTries && !other.refusals.empty(); ++tries) {
    other.ranking.front().refused = describe(other.refusals.front());
    const auto next = next_direction(other.ranking);
    if (!next) return;
    plan_along(*next, design, settings, hooks, watch, other);
  }
  if (!other.refusals.empty()) return;
  other.times = std::move(result.times);
  result = std::move(other);
}

// What came of a try.
Decision decision_of(const std::string& way, const PlanResult& result) {
  Decision d;
  d.way = way;
  d.normal = result.ranking.front().normal;
  d.fan = result.ranking.front().fan.has_value();
  d.strips = result.strips.size();
  for (const StripFacts& f : result.strips) {
    d.ribs += f.ribs;
    d.fit_mm = std::max(d.fit_mm, f.worst_fit_mm);
  }
  d.deviation_mm = result.verification.deviation.max;
  d.passed = result.refusals.empty();
  if (!d.passed) d.why = describe(result.refusals.front());
  return d;
}

Decision decision_of(const SweptPlan& swept, const PlanResult& result) {
  Decision d;
  if (!swept.refusals.empty()) {
    d.normal = swept.planes.normal(0);
    d.fan = swept.planes.turns();
    d.strips = swept.strips.size() + swept.refusals.size();
    d.why = describe(swept.refusals.front());
  } else {
    d = decision_of("sweep", result);
  }
  d.way = "sweep";
  d.fit_mm = swept.deviation_mm;
  return d;
}

// Verifies a swept plan in full.
void plan_swept(const SweptPlan& swept, const surface::DesignSurface& design, const Settings& settings,
                const PlanHooks& hooks, Stopwatch& watch, PlanResult& result) {
  result.program.strips.clear();
  result.strips.clear();
  result.warnings.clear();
  result.refusals.clear();
  result.refinements = 0;
  DirectionScore direction;
  direction.normal = swept.planes.normal(0);
  direction.estimated = false;
  if (swept.planes.turns()) direction.fan = surface::FanAxis{swept.planes.centre(), swept.planes.axis()};
  direction.strips = swept.strips.size();
  direction.deviation_mm = swept.deviation_mm;
  result.ranking.insert(result.ranking.begin(), direction);
  if (!swept.strips.empty()) {
    const std::vector<RibFit>& ribs = swept.strips.front().ribs;
    result.spacing_mm =
        (ribs.back().offset_mm - ribs.front().offset_mm) / static_cast<double>(ribs.size() - 1);
  }
  StripLayout layout;
  layout.strips = swept.strips;
  result.refusals = swept.refusals;
  pose_and_verify(layout, design, settings, hooks, watch, result);
  judge(settings, result);
}

// The strips that refusals speak of, and those that deviate by more than allowed.
std::vector<bool> failed_strips(const PlanResult& result) {
  std::vector<bool> failed;
  for (const StripFacts& strip : result.strips) {
    const bool refused = std::any_of(result.refusals.begin(), result.refusals.end(), [&](const Refusal& r) {
      return r.strip == strip.id || r.strip.starts_with(strip.id + " ");
    });
    failed.push_back(refused || strip.deviation_max_mm > result.program.settings.design.tolerance_mm);
  }
  if (std::none_of(failed.begin(), failed.end(), [](bool f) { return f; })) failed.clear();
  return failed;
}

// The refused plan that comes nearest to one that passes: what is shown when none does.
class Nearest {
 public:
  void offer(const SweptPlan& swept, const PlanResult* verified) {
    const std::vector<bool> failed = verified ? failed_strips(*verified) : std::vector<bool>{};
    const auto failing = static_cast<std::size_t>(std::count(failed.begin(), failed.end(), true));
    // What was verified says more than a part that has no strip; then the fewer kinds of limits it breaks the
    // better, as each takes a change of its own.
    std::set<Limit> limits;
    for (const Refusal& r : verified ? verified->refusals : swept.refusals) limits.insert(r.limit);
    const std::tuple rank{verified == nullptr, limits.size(), swept.refusals.size() + failing,
                          swept.strips.size()};
    if (rank_ && !(rank < *rank_)) return;
    rank_ = rank;
    swept_ = swept;
    verified_ = verified ? std::optional(*verified) : std::nullopt;
  }

  void show(const surface::DesignSurface& design, const Settings& settings, const PlanHooks& hooks,
            Stopwatch& watch, PlanResult& result) {
    PlanResult shown = verified_ ? std::move(*verified_) : result;
    if (!verified_ && rank_) plan_swept(swept_, design, settings, hooks, watch, shown);
    if (!rank_) {
      shown.refusals = {leaning_refusal(settings)};
      pose_and_verify({}, design, settings, hooks, watch, shown);
      judge(settings, shown);
    }
    shown.decisions = std::move(result.decisions);
    shown.times = std::move(result.times);
    result = std::move(shown);
  }

 private:
  // Nothing is tried where `keep` does not tell the waste's side.
  static Refusal leaning_refusal(const Settings& settings) {
    return {"design",
            "",
            Limit::kLean,
            0,
            kLeastLean,
            "design.keep = \"" + std::string(name(settings.design.keep)) +
                "\" says nothing about an upright surface"};
  }

  std::optional<std::tuple<bool, std::size_t, std::size_t, std::size_t>> rank_;
  SweptPlan swept_;
  std::optional<PlanResult> verified_;
};

// Each strip as one swept family: the first such plan that passes is taken.
void try_sweeps(const surface::DesignSurface& design, const Settings& settings, const PlanHooks& hooks,
                Stopwatch& watch, PlanResult& result) {
  bool taken = false;
  Nearest nearest;
  hooks.progress("sweep", 0);
  const auto judged = [&](const SweptPlan& swept) -> SweepVerdict {
    watch.lap("sweep");
    check_interrupt(hooks);
    PlanResult other = result;
    const bool whole = swept.refusals.empty();
    if (whole) plan_swept(swept, design, settings, hooks, watch, other);
    result.decisions.push_back(decision_of(swept, other));
    if (!whole || !other.refusals.empty()) {
      nearest.offer(swept, whole ? &other : nullptr);
      return {false, whole ? failed_strips(other) : std::vector<bool>{}};
    }
    other.decisions = std::move(result.decisions);
    other.times = std::move(result.times);
    result = std::move(other);
    for (Decision& d : result.decisions) d.taken = &d == &result.decisions.back();
    taken = true;
    return {true, {}};
  };
  std::mutex telling;
  const auto watched = [&](double) {
    check_interrupt(hooks);
    const std::scoped_lock lock(telling);
    hooks.progress("sweep", 0);
  };
  try {
    search_sweeps(design, settings, judged, watched);
  } catch (const surface::FanError& error) {
    throw Error(ErrorKind::kNotCuttable, error.what());
  }
  if (!taken) nearest.show(design, settings, hooks, watch, result);
}

// Ribs fitted one by one, in the best directions.
void try_ribs(const surface::DesignSurface& design, const Settings& settings, const PlanHooks& hooks,
              Stopwatch& watch, PlanResult& result) {
  hooks.progress("direction", 0);
  try {
    result.ranking = rank_directions(design, settings, DirectionSearch::kBounded, [&] {
      check_interrupt(hooks);
      hooks.progress("direction", 0);
    });
  } catch (const surface::FanError& error) {
    throw Error(ErrorKind::kNotCuttable, error.what());
  }
  watch.lap("direction");
  hooks.progress("slice", 0);
  check_interrupt(hooks);
  plan_along(0, design, settings, hooks, watch, result);
  try_others(design, settings, hooks, watch, result);
  result.decisions.push_back(decision_of("ribs", result));
  result.decisions.back().taken = true;
}

}  // namespace

std::string clamp_coordinate_name(std::size_t coordinate) {
  constexpr std::array<const char*, 6> kNames{"along_a", "across_a", "turn_a",
                                              "along_b", "across_b", "turn_b"};
  return kNames.at(coordinate);
}

PlanResult plan(const surface::DesignSurface& design, const Settings& settings, const PlanHooks& hooks) {
  PlanResult result;
  Program& program = result.program;
  program.created_by = "hotblade " + version();
  program.design = design_data(design, settings);
  program.blade = settings.blade;
  program.settings = settings;
  Stopwatch watch(result.times);
  PlanProgress progress(hooks.progress);
  constexpr double kSweepsEnd = 0.95, kDirectionsEnd = 0.55;
  PlanHooks sweeps = hooks, ribs = hooks;
  sweeps.progress = [&](const std::string& stage, double) { progress.step(stage, kSweepsEnd); };
  ribs.progress = [&](const std::string& stage, double share) {
    stage == "direction" ? progress.step(stage, kDirectionsEnd) : progress.attempt(stage, share);
  };
  // A family has one blade on both sides of a window.
  if (settings.slice.gaps == Gaps::kApart) {
    try_ribs(design, settings, ribs, watch, result);
  } else {
    try_sweeps(design, settings, sweeps, watch, result);
  }
  result.strips_lower_bound = strips_lower_bound(result.verification.area_mm2, settings);
  warn_of_facets(design, settings, result);
  Verification& v = program.verification;
  v.tolerance_mm = settings.design.tolerance_mm;
  v.deviation_mm = result.verification.deviation;
  v.uncut_mm2 = result.verification.uncut_mm2;
  v.budget_mm = error_budget(design, program, pose_errors(result.strips));
  v.samples = result.verification.cut_samples + result.verification.design_samples;
  v.not_checked = not_checked();
  if (!result.verification.within_tolerance && result.refusals.empty()) {
    throw std::logic_error("a deviation that is not a number must not pass");
  }
  v.status = result.refusals.empty() ? VerificationStatus::kPassed : VerificationStatus::kRefused;
  judge_budget(settings, result);
  return result;
}

}  // namespace hotblade::pipeline
