#include "pipeline/plan/plan.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/deviation_reasons.hpp"
#include "pipeline/plan/face_plans.hpp"
#include "pipeline/plan/nearest_plan.hpp"
#include "pipeline/plan/plan_progress.hpp"
#include "pipeline/plan/stopwatch.hpp"
#include "pipeline/plan/strip_looks.hpp"
#include "pipeline/plan/suggestions.hpp"
#include "pipeline/plan/sweep/sweep_directions.hpp"
#include "pipeline/plan/sweep/sweep_search.hpp"
#include "pipeline/program/freed_memory.hpp"
#include "pipeline/program/version.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/stock/foam_to_buy.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/design_faces.hpp"
#include "pipeline/verify/rib_measures.hpp"
#include "pipeline/verify/verdict.hpp"
#include "robot/blade/blade_section.hpp"
#include "surface/slice/smooth_faces.hpp"

namespace hotblade::pipeline {

namespace {

// Of a try that is looked at in full, what is done when its strips are posed.
constexpr double kPosed = 0.6;

DesignData design_data(const surface::DesignSurface& design, const Settings& settings) {
  return {design.file_name,     design.sha256,          design.units,
          design.format,        design.scale_to_mm,     design.up,
          settings.design.keep, design.health.vertices, design.health.triangles,
          design.health.bbox_mm};
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

VerifyOptions verify_options(const Settings& settings, gpu::Backend backend) {
  VerifyOptions options;
  options.tolerance_mm = settings.design.tolerance_mm;
  options.max_uncut_share = settings.design.max_uncut_share;
  options.backend = backend;
  options.min_margin = settings.blade.min_margin;
  return options;
}

void take_report(VerifyReport report, PlanResult& result) {
  result.verification = std::move(report);
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    result.strips[i].deviation_max_mm = result.verification.strip_max_mm[i];
    result.strips[i].deviation_bound_mm = result.verification.strip_bound_mm[i];
  }
}

void measure_cut(const surface::DesignSurface& design, gpu::Backend backend, PlanResult& result) {
  VerifyOptions options = verify_options(result.program.settings, backend);
  options.motion = false;
  take_report(verify(result.program, design, options), result);
}

// Limits of the whole: the deviation and the area left out.
void judge(const Settings& settings, PlanResult& result) {
  const VerifyReport& v = result.verification;
  if (result.strips.empty() && result.refusals.empty()) {
    result.refusals.push_back({"design", "", Limit::kStrips, 0, 1});
  }
  for (const StripFacts& f : result.strips) {
    const double together = f.deviation_with_sag_mm();
    if (together <= settings.design.tolerance_mm || f.deviation_bound_mm > settings.design.tolerance_mm)
      continue;
    result.refusals.push_back({f.id, "", Limit::kDeviationWithSag, together, settings.design.tolerance_mm});
  }
  for (std::size_t i = 0; i < v.branches.size(); ++i) {
    if (!v.branches[i].held())
      result.refusals.push_back(branch_refusal(result.program.strips[i], v.branches[i]));
  }
  for (const FarBezier& bezier : v.ribs.far) result.refusals.push_back(refusal_of(bezier));
  if (v.bound_mm > settings.design.tolerance_mm)
    result.refusals.push_back(deviation_refusal(result, settings.design.tolerance_mm));
  // Without strips all is uncut: what stands before says why.
  if (v.uncut_share() > settings.design.max_uncut_share &&
      !(result.strips.empty() && !result.refusals.empty())) {
    result.refusals.push_back(
        {"design", "", Limit::kUncutShare, 100 * v.uncut_share(), 100 * settings.design.max_uncut_share});
  }
}

// Ribs follow the facets of the file, not the surface that they stand for.
void warn_of_facets(const Settings& settings, PlanResult& result) {
  const double chord = result.program.verification.budget_mm.front().second;  // the mesh's line
  const double allowed = settings.fit.deviation_share * settings.design.tolerance_mm;
  if (chord <= allowed) return;
  result.warnings.push_back(say(Saying::kFacets, {chord, allowed}));
}

PoseErrors pose_errors(const PlanResult& result) {
  PoseErrors share;
  for (const BranchReport& branch : result.verification.branches)
    share.told_mm = std::max(share.told_mm, branch.told_off_mm);
  for (const StripFacts& f : result.strips) {
    share.droop_mm = std::max(share.droop_mm, robot::kSagUnknownShare * f.droop_error_mm);
    share.in_plane_mm = std::max(share.in_plane_mm, robot::kSagUnknownShare * f.motion.in_plane_sag_mm);
    share.clamp_mm = std::max(share.clamp_mm, f.motion.clamp_error_mm);
    share.joint_fit_mm = std::max(share.joint_fit_mm, f.joint_fit_mm);
    share.off_plane_mm = std::max(share.off_plane_mm, f.motion.off_plane_mm);
  }
  return share;
}

// What the program says of itself, once all is measured.
void conclude(const surface::DesignSurface& design, PlanResult& result) {
  Program& program = result.program;
  const Settings& settings = program.settings;
  Verification& v = program.verification;
  v.tolerance_mm = settings.design.tolerance_mm;
  v.deviation_mm = result.verification.deviation;
  v.uncut_mm2 = result.verification.uncut_mm2;
  v.budget_mm = error_budget(design, program, pose_errors(result));
  v.samples = result.verification.cut_samples + result.verification.design_samples;
  v.not_checked = not_checked(program.blade);
  if (settings.motion.jerk_mm_s3 > 0 && settings.motion.angular_jerk_rad_s3 > 0) {
    for (std::string& item : v.not_checked)
      if (item == say(Saying::kJerkUnlimited)) item = say(Saying::kJerkOfHolds);
  }
  if (!result.verification.within_tolerance && result.refusals.empty()) {
    throw std::logic_error("a deviation that is not a number must not pass");
  }
  v.status = result.refusals.empty() ? VerificationStatus::kPassed : VerificationStatus::kRefused;
}

// Errors that no measurement of the plan can see may be over the tolerance together with those it can.
void warn_of_budget(const Settings& settings, PlanResult& result) {
  if (result.verification.cut_samples == 0 || settings.design.over_budget != OverBudget::kWarn) return;
  const Verdict verdict = verdict_of(result.program);
  if (verdict.over_budget()) result.warnings.push_back(say(Saying::kOfDesign, {budget_text(verdict)}));
}

// Where the budget binds, it does so as the other limits do, when a plan is looked at: another may keep it.
void judge_budget(const surface::DesignSurface& design, const Settings& settings, PlanResult& result) {
  if (settings.design.over_budget != OverBudget::kRefuse || !result.refusals.empty() ||
      result.verification.cut_samples == 0)
    return;
  conclude(design, result);
  const Verdict verdict = verdict_of(result.program);
  if (!verdict.over_budget()) return;
  result.refusals.push_back(
      {"design", "", Limit::kBudget, verdict.budget_mm, verdict.tolerance_mm, needed_text(verdict)});
}

// What came of a try.
Decision decision_of(const SweptPlan& swept, const PlanResult& result) {
  Decision d;
  d.way = swept.way;
  d.fits = swept.fits;
  d.normal = swept.planes.normal(0);
  d.fan = swept.planes.turns();
  d.fit_mm = swept.deviation_mm;
  d.strips = swept.parts;
  if (!swept.refusals.empty()) {
    d.stopped_by = swept.refusals.front();
    return d;
  }
  for (const StripFacts& f : result.strips) d.ribs += f.ribs;
  d.deviation_mm = result.verification.deviation.max;
  d.passed = result.refusals.empty();
  if (!d.passed) d.stopped_by = result.refusals.front();
  return d;
}

// Looks at the plans of one design. Of a plan that follows another only strips that changed are posed and
// measured, as long as one of them fails.
class PlanLooks {
 public:
  // `empty` has what all results have in common.
  PlanLooks(const surface::DesignSurface& design, const Settings& settings, const PlanHooks& hooks,
            Stopwatch& watch, const PlanResult& empty)
      : design_(design), settings_(settings), hooks_(hooks), watch_(watch) {
    empty_.program = empty.program;
  }

  struct Seen {
    PlanResult result;   // judged
    bool whole = false;  // with what of the design is left uncut, its ribs and its poses
  };

  // Each strip by itself, more coarsely than in full: where it leaves the design and what of its motion is
  // refused.
  Seen coarsely(const SweptPlan& swept) {
    coarse_.pose(swept.strips, settings_, [&](double share) { hooks_.progress("pose", share); });
    coarse_.measure_fresh(empty_.program, design_, coarser());
    watch_.lap("look");
    return {judged(coarse_.known()), false};
  }

  // In full: where few strips changed these first, and the whole when they pass.
  Seen in_full(const SweptPlan& swept) {
    pose(full_, swept);
    if (2 * full_.fresh() < full_.count()) {
      full_.measure_fresh(empty_.program, design_, verify_options(settings_, hooks_.backend));
      PlanResult known = judged(full_.known());
      watch_.lap("verify");
      if (!known.refusals.empty()) return {std::move(known), false};
    }
    return {whole(swept), true};
  }

  // All of a plan in full.
  PlanResult whole(const SweptPlan& swept) {
    pose(full_, swept);
    PlanResult result = started(swept);
    full_.give(result);
    measure_ribs(result.program, hooks_.backend);
    hooks_.progress("verify", kPosed);
    give_back_freed_memory();
    measure_cut(design_, hooks_.backend, result);
    judge(settings_, result);
    judge_budget(design_, settings_, result);
    watch_.lap("verify");
    return result;
  }

  // Keeps the strips of a plan that was refused for the next one.
  void keep(Seen& seen) {
    if (seen.whole) full_.take_back(seen.result);
  }

  // A plan that was seen whole, with its strips again.
  PlanResult with_strips(const SweptPlan& swept, PlanResult result) {
    pose(full_, swept);
    PlanResult again;
    full_.give(again);
    result.program.strips = std::move(again.program.strips);
    measure_ribs(result.program, hooks_.backend);
    return result;
  }

  // All of a plan, but its poses and samples farther apart and without the clamps' errors: for one of many
  // strips that is refused, and only shown.
  PlanResult shown_coarsely(const SweptPlan& swept) {
    StripLooks looks(MotionLook::kCoarse);
    pose(looks, swept);
    PlanResult result = started(swept);
    looks.give(result);
    measure_ribs(result.program, hooks_.backend);
    hooks_.progress("verify", kPosed);
    take_report(measure(result.program, {}, design_, coarser()), result);
    judge(settings_, result);
    result.warnings.push_back(say(Saying::kShownCoarsely, {}));
    watch_.lap("verify");
    return result;
  }

 private:
  [[nodiscard]] VerifyOptions coarser() const {
    constexpr double kCoarser = 2;
    VerifyOptions options = verify_options(settings_, hooks_.backend);
    options.sample_mm *= kCoarser;
    return options;
  }

  void pose(StripLooks& looks, const SweptPlan& swept) {
    looks.pose(swept.strips, settings_, [&](double share) { hooks_.progress("pose", share * kPosed); });
    watch_.lap("pose");
  }

  // A result with what is known of a plan before its strips are looked at.
  [[nodiscard]] PlanResult started(const SweptPlan& swept) const {
    PlanResult result = empty_;
    for (const StripPlan& strip : swept.strips) {
      const auto gaps = static_cast<double>(strip.ribs.size() - 1);
      result.spacing_mm =
          std::max(result.spacing_mm, (strip.ribs.back().offset_mm - strip.ribs.front().offset_mm) / gaps);
    }
    result.refusals = swept.refusals;
    return result;
  }

  [[nodiscard]] PlanResult judged(PlanResult known) const {
    known.program.settings = empty_.program.settings;
    judge(settings_, known);
    return known;
  }

  const surface::DesignSurface& design_;
  const Settings& settings_;
  const PlanHooks& hooks_;
  Stopwatch& watch_;
  PlanResult empty_;
  StripLooks coarse_{MotionLook::kCoarse}, full_{MotionLook::kFull};
};

// Nothing is tried where `keep` does not tell the waste's side.
Refusal leaning_refusal(const surface::DesignSurface& design, const Settings& settings) {
  const bool closed = design.health.closed && !settings.design.facing;
  const std::string why = closed ? say(Saying::kClosed) : say(Saying::kUpright, {name(settings.design.keep)});
  return {"design", "", Limit::kLean, 0, kLeastLean, why};
}

// The refused plan that comes nearest to one that passes: what is shown when none does.
class Nearest {
 public:
  // `seen` without its strips; null where it was not looked at.
  void offer(const SweptPlan& swept, const PlanLooks::Seen* seen) {
    const Nearness rank = nearness(swept, seen ? &seen->result : nullptr);
    if (rank_ && !(rank < *rank_)) return;
    rank_ = rank;
    swept_ = swept;
    verified_ = seen && seen->whole ? std::optional(seen->result) : std::nullopt;
  }

  // The plan that was offered, without strips where none was.
  [[nodiscard]] const SweptPlan& swept() const { return swept_; }

  [[nodiscard]] PlanResult shown(const surface::DesignSurface& design, const Settings& settings,
                                 const PlanHooks& hooks, PlanLooks& looks) const {
    // As many take as long to look at in full as the search took, or longer.
    constexpr std::size_t kMostInFull = 32;
    if (verified_) return looks.with_strips(swept_, *verified_);
    if (swept_.strips.size() > kMostInFull && !hooks.refused_too) return looks.shown_coarsely(swept_);
    PlanResult shown = looks.whole(swept_);
    // Without anything to try no part was found, which the judgement says.
    if (!rank_ && waste_side(design.mesh, settings.design.keep) == 0)
      shown.refusals = {leaning_refusal(design, settings)};
    return shown;
  }

 private:
  std::optional<Nearness> rank_;
  SweptPlan swept_;
  std::optional<PlanResult> verified_;
};

SweepVerdict verdict_on(const PlanResult& looked) {
  return {looked.refusals.empty(), failed_strips(looked), too_far_strips(looked), misshapen_strips(looked),
          deviations_with_sag_mm(looked)};
}

// A result takes the place of the one that has the tries so far, and their times.
void take(PlanResult other, PlanResult& result) {
  other.decisions = std::move(result.decisions);
  other.times = std::move(result.times);
  result = std::move(other);
}

// Each strip as one swept family: the first such plan that passes is taken. Families follow `formed`, which
// is the design or its one face, and all of the design is measured. `hooks` are told of what is looked at in
// full, `progress` of the rest. Returns the plan that is shown.
SweptPlan try_sweeps(const surface::DesignSurface& design, const surface::DesignSurface& formed,
                     const Settings& settings, const PlanHooks& hooks, PlanProgress& progress,
                     Stopwatch& watch, PlanResult& result, std::size_t most_parts = kMostStrips) {
  std::optional<SweptPlan> taken;
  Nearest nearest;
  PlanLooks looks(design, settings, hooks, watch, result);
  SweepJudges judges;
  judges.together = [&](const SweptPlan& swept) -> SweepVerdict {
    watch.lap("sweep");
    PlanLooks::Seen seen;
    const bool any = swept.refusals.empty();
    if (any) seen = looks.in_full(swept);
    result.decisions.push_back(decision_of(swept, seen.result));
    result.decisions.back().alone = any && !seen.whole;
    if (any && seen.whole && seen.result.refusals.empty()) {
      take(std::move(seen.result), result);
      for (Decision& d : result.decisions) d.taken = &d == &result.decisions.back();
      taken = swept;
      return {true, {}};
    }
    if (any) looks.keep(seen);
    nearest.offer(swept, any ? &seen : nullptr);
    progress.next_try();
    return any ? verdict_on(seen.result) : SweepVerdict{};
  };
  judges.alone = [&](const SweptPlan& swept) -> SweepVerdict {
    watch.lap("sweep");
    const PlanLooks::Seen seen = looks.coarsely(swept);
    result.decisions.push_back(decision_of(swept, seen.result));
    result.decisions.back().alone = true;
    return verdict_on(seen.result);
  };
  judges.given_up = [&](const SweptPlan& swept) {
    const PlanLooks::Seen seen = looks.coarsely(swept);
    nearest.offer(swept, &seen);
  };
  const auto watched = [&] { progress.fitted(); };
  BandsOfSweep bands;
  if (settings.blade.melt.by_speed())
    bands = [&](const SweptPlan& swept) { return bands_of(swept.strips, settings); };
  std::vector<PlanesTried> ranking;
  try {
    ranking = search_sweeps(formed, settings, judges, watched, bands, most_parts);
  } catch (const surface::FanError& error) {
    throw Error(ErrorKind::kNotCuttable, error.what());
  }
  if (!taken) take(nearest.shown(design, settings, hooks, looks), result);
  result.ranking = std::move(ranking);
  return taken.value_or(nearest.swept());
}

// A design with creases: no blade goes over one within the tolerance, so each of the faces that meet there is
// planned as a design of its own, and the whole is measured then.
SweptPlan try_faces(const surface::DesignSurface& design, const std::vector<surface::TriangleMesh>& meshes,
                    const Settings& settings, const PlanHooks& hooks, PlanProgress& progress,
                    Stopwatch& watch, PlanResult& result) {
  Settings own = settings;
  // The whole tells the waste's side: a face may stand upright.
  if (const double side = waste_side(design.mesh, settings.design.keep); side != 0)
    own.design.keep = side > 0 ? Keep::kBack : Keep::kFront;
  std::vector<SweptPlan> swept(meshes.size());
  std::vector<PlanResult> planned(meshes.size());
  std::vector<Refusal> untried;
  largest_first(meshes, [&](std::size_t i) {
    planned[i].program = result.program;
    const surface::DesignSurface alone = face_of(design, meshes[i]);
    swept[i] = try_sweeps(alone, alone, own, hooks, progress, watch, planned[i]);
    planned[i].program = {};
    // What is refused before any strip is tried, and told once.
    if (swept[i].strips.empty() && swept[i].refusals.empty()) untried = planned[i].refusals;
    return !swept[i].strips.empty();
  });
  SweptPlan whole;
  whole.way = SweepWay::kFaces;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    PlanResult& face = planned[i];
    result.faces.push_back({{whole.strips.size(), swept[i].strips.size()},
                            {result.decisions.size(), face.decisions.size()},
                            {result.ranking.size(), face.ranking.size()},
                            strips_lower_bound(area_mm2(meshes[i]), settings)});
    append(whole, std::move(swept[i]));
    for (Decision& d : face.decisions) d.taken = false;
    std::move(face.decisions.begin(), face.decisions.end(), std::back_inserter(result.decisions));
    std::move(face.ranking.begin(), face.ranking.end(), std::back_inserter(result.ranking));
  }
  // Of the whole, which may be closed where none of its faces is.
  for (Refusal& r : untried)
    if (r.limit == Limit::kLean) r = leaning_refusal(design, settings);
  whole.refusals.insert(whole.refusals.end(), untried.begin(), untried.end());
  PlanResult all = PlanLooks(design, settings, hooks, watch, result).whole(whole);
  all.faces = std::move(result.faces);
  all.ranking = std::move(result.ranking);
  take(std::move(all), result);
  result.decisions.push_back(decision_of(whole, result));
  result.decisions.back().taken = result.refusals.empty();
  return whole;
}

// The faces of a design with its shallow folds crossed or parted, which settings and program say from then
// on.
std::vector<surface::TriangleMesh> faces_with(ShallowFolds folds, const surface::DesignSurface& design,
                                              Settings& settings, PlanResult& result) {
  settings.slice.shallow_folds = result.program.settings.slice.shallow_folds = folds;
  return surface::smooth_faces(design.mesh, crease_limits(settings, settings.blade));
}

// A blade that is swept across a shallow fold rounds it, but none goes far to both sides of one. So where the
// settings leave it open strips go over such folds where fewer of these serve than there are faces between
// them, and likewise over parts of a design that lie apart. Returns the plan that is shown.
SweptPlan try_folds(const surface::DesignSurface& design, Settings& settings, const PlanHooks& hooks,
                    PlanProgress& progress, Stopwatch& watch, PlanResult& result) {
  const auto plan_faces = [&](const std::vector<surface::TriangleMesh>& faces, PlanResult& planned,
                              std::size_t most = kMostStrips) {
    if (faces.size() > 1) return try_faces(design, faces, settings, hooks, progress, watch, planned);
    // Slivers at a hull are of no face.
    const bool all = faces.front().triangles().size() == design.mesh.triangles().size();
    return try_sweeps(design, all ? design : face_of(design, faces.front()), settings, hooks, progress, watch,
                      planned, most);
  };
  const ShallowFolds asked = settings.slice.shallow_folds;
  const bool open = asked == ShallowFolds::kAuto;
  auto parted = faces_with(open ? ShallowFolds::kParted : asked, design, settings, result);
  const auto crossed = open ? faces_with(ShallowFolds::kCrossed, design, settings, result) : parted;
  // As parts are planned one by one: without such folds it is the same.
  const ShallowFolds folds =
      open && parted.size() > crossed.size() ? ShallowFolds::kParted : settings.slice.shallow_folds;
  if (parted.size() == 1) parted = parts_apart(parted.front());
  if (parted.size() == crossed.size()) return plan_faces(crossed, result);
  const Program blank = result.program;
  const auto passes = [](const PlanResult& planned) {
    return planned.refusals.empty() && !planned.program.strips.empty();
  };
  // Plans over the folds, beside what there is; absent where that does not pass.
  const auto over_folds = [&](std::size_t most) -> std::optional<SweptPlan> {
    PlanResult over;
    over.program = blank;
    SweptPlan swept = plan_faces(crossed, over, most);
    if (!passes(over)) {
      result.decisions.insert(result.decisions.end(), over.decisions.begin(), over.decisions.end());
      if (result.ranking.empty()) result.ranking = std::move(over.ranking);
      return std::nullopt;
    }
    over.times = std::move(result.times);
    for (FacePlanned& face : over.faces) face.decisions.first += result.decisions.size();
    over.decisions.insert(over.decisions.begin(), result.decisions.begin(), result.decisions.end());
    result = std::move(over);
    return swept;
  };
  const std::size_t most = parted.size() - 1;
  if (crossed.size() == 1 && strips_lower_bound(design.health.area_mm2, settings) <= most &&
      may_share_a_block(parted, settings.stock)) {
    if (std::optional<SweptPlan> swept = over_folds(most)) return std::move(*swept);
  }
  settings.slice.shallow_folds = result.program.settings.slice.shallow_folds = folds;
  SweptPlan apart = plan_faces(parted, result);
  if (passes(result)) return apart;
  const auto creases = surface::creases(design.mesh, crease_limits(settings, settings.blade));
  if (creases.bands.empty()) return apart;
  // Strips that follow a fillet come nearer to it than the corner does that its sides make.
  settings.slice.shallow_folds = ShallowFolds::kCrossed;
  if (std::optional<SweptPlan> swept = over_folds(kMostStrips)) return std::move(*swept);
  settings.slice.shallow_folds = ShallowFolds::kParted;
  return apart;
}

void try_design(const surface::DesignSurface& design, Settings& settings, const PlanHooks& hooks,
                PlanProgress& progress, Stopwatch& watch, PlanResult& result) {
  const SweptPlan shown = try_folds(design, settings, hooks, progress, watch, result);
  if (!result.refusals.empty()) return;
  tbb::parallel_for(std::size_t{0}, result.strips.size(), [&](std::size_t i) {
    result.strips[i].blades = try_other_blades(shown.strips[i], settings);
  });
  gpu::stop_point();
}

}  // namespace

std::string clamp_coordinate_name(std::size_t coordinate) {
  constexpr std::array<const char*, 6> kNames{"along_a", "across_a", "turn_a",
                                              "along_b", "across_b", "turn_b"};
  return kNames.at(coordinate);
}

PlanResult plan(const surface::DesignSurface& design, const Settings& given, const PlanHooks& hooks) {
  Settings settings = with_true_lengths(given);
  PlanResult result;
  Program& program = result.program;
  program.created_by = "hotblade " + version();
  program.design = design_data(design, settings);
  program.blade = settings.blade;
  program.settings = given;
  Stopwatch watch(result.times);
  // Ranking takes some hundred fits, and every strip some more.
  constexpr double kRankingFits = 100, kFitsOfStrip = 8;
  const std::size_t fewest = strips_lower_bound(design.health.area_mm2, settings);
  PlanProgress progress(hooks.progress, kRankingFits + kFitsOfStrip * static_cast<double>(fewest));
  PlanHooks looking = hooks;
  looking.progress = [&](const std::string& stage, double share) { progress.looked_at(stage, share); };
  try_design(design, settings, looking, progress, watch, result);
  explain_deviations(design, settings, result);
  result.strips_lower_bound = fewest;
  conclude(design, result);
  warn_of_facets(settings, result);
  warn_of_budget(program.settings, result);
  result.foam = foam_to_buy(program, [&] {
    gpu::stop_point();
    progress.looked_at("verify", 1);
  });
  return result;
}

void measure_again(const surface::DesignSurface& design, gpu::Backend backend, PlanResult& result) {
  measure_cut(design, backend, result);
  // The budget's warning is said again, with what it is now.
  std::erase_if(result.warnings,
                [](const std::string& line) { return line.starts_with("design: error budget"); });
  for (std::size_t i = 0; i < result.strips.size(); ++i)
    set_bands(result.program.strips[i].poses, result.program.settings, result.strips[i]);
  // What was looked at since is no question of times.
  std::vector<std::string> not_checked = std::move(result.program.verification.not_checked);
  judge(result.program.settings, result);
  judge_budget(design, result.program.settings, result);
  conclude(design, result);
  result.program.verification.not_checked = std::move(not_checked);
  warn_of_budget(result.program.settings, result);
}

}  // namespace hotblade::pipeline
