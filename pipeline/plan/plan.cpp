#include "pipeline/plan/plan.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/nearest_plan.hpp"
#include "pipeline/plan/plan_progress.hpp"
#include "pipeline/plan/planned_ribs.hpp"
#include "pipeline/plan/stopwatch.hpp"
#include "pipeline/plan/suggestions.hpp"
#include "pipeline/plan/sweep/sweep_directions.hpp"
#include "pipeline/plan/sweep/sweep_search.hpp"
#include "pipeline/program/version.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/stock/foam_to_buy.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/design_faces.hpp"
#include "pipeline/verify/foam_share.hpp"
#include "pipeline/verify/mesh_view.hpp"
#include "pipeline/verify/rib_measures.hpp"
#include "pipeline/verify/verdict.hpp"
#include "robot/blade/blade_section.hpp"
#include "surface/slice/creases.hpp"

namespace hotblade::pipeline {

namespace {

// Of a try that is looked at in full, what is done when its strips are posed.
constexpr double kPosed = 0.6;

// The narrowest and the widest band by the speeds of poses.
void set_bands(const std::vector<BladePose>& poses, const Settings& settings, StripFacts& facts) {
  facts.band_min_mm = facts.band_max_mm = settings.blade.kerf_mm;
  if (!settings.blade.melt.by_speed()) return;
  const BladeSpeeds speeds(poses);
  const double feed = settings.motion.feed_mm_s;
  const auto [slowest, fastest] = speeds.empty() ? std::pair(feed, feed) : speeds.range();
  facts.band_min_mm = settings.blade.band_mm(fastest);
  facts.band_max_mm = settings.blade.band_mm(slowest);
}

// A blade that goes slower than anybody measured melts wider than the plan takes.
void warn_of_slow_melt(const std::string& strip, const std::vector<BladePose>& poses,
                       const Settings& settings, std::vector<std::string>& warnings) {
  const auto& pairs = settings.blade.melt.band_mm_at_mm_s;
  if (pairs.empty()) return;
  const BladeSpeeds speeds(poses);
  if (speeds.empty() || speeds.range().first >= pairs.front()[0]) return;
  warnings.push_back(
      say(Saying::kSlowMelt, {strip, speeds.range().first, pairs.front()[0], pairs.front()[1]}));
}

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
  f.joint_fit_mm = plan.joint_fit_mm;
  f.seam = plan.seam_before;
  // The twist tilts the section, whose edges move by half its width.
  f.droop_error_mm =
      f.motion.droop_mm * std::sin(steepest) + 0.5 * settings.blade.width_mm * f.motion.twist_rad;
  f.stock_volume_mm3 = plan.block.size_mm.prod();
  set_bands(posed.motion.poses, settings, f);
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
  warn_of_slow_melt(posed.strip.id, posed.motion.poses, settings, planned.warnings);
  planned.strip = make_strip(posed.strip, std::move(posed.motion.poses), settings.design.tolerance_mm);
  planned.facts.foam_kept_share = foam_kept_share(planned.strip);
  return planned;
}

DesignData design_data(const surface::DesignSurface& design, const Settings& settings) {
  return {design.file_name,     design.sha256,          design.units,
          design.format,        design.scale_to_mm,     design.up,
          settings.design.keep, design.health.vertices, design.health.triangles,
          design.health.bbox_mm};
}

// Strips are posed side by side and handed over in their order.
void pose_strips(const std::vector<StripPlan>& strips, const Settings& settings, const PlanHooks& hooks,
                 MotionLook look, PlanResult& result) {
  const std::size_t count = strips.size();
  std::vector<PlannedStrip> planned(count);
  std::mutex telling;
  std::size_t told = 0;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    PosedStrip posed{strips[i], move_blade(strips[i], settings, look)};
    posed.strip.design_to_cell.p.z() += posed.motion.raise_mm;
    planned[i] = planned_strip(std::move(posed), settings);
    const std::scoped_lock lock(telling);
    const double posed_share = static_cast<double>(++told) / static_cast<double>(count);
    hooks.progress("pose", posed_share * kPosed);
  });
  gpu::stop_point();
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
  take_report(verify(result.program, design, verify_options(result.program.settings, backend)), result);
}

// Poses strips, and measures what they cut.
void pose_and_verify(const std::vector<StripPlan>& strips, const surface::DesignSurface& design,
                     const Settings& settings, const PlanHooks& hooks, Stopwatch& watch, PlanResult& result) {
  pose_strips(strips, settings, hooks, MotionLook::kFull, result);
  watch.lap("pose");
  measure_ribs(result.program, hooks.backend);
  hooks.progress("verify", kPosed);
  measure_cut(design, hooks.backend, result);
  watch.lap("verify");
}

// Limits of the whole: the deviation and the area left out.
void judge(const Settings& settings, PlanResult& result) {
  const VerifyReport& v = result.verification;
  if (result.program.strips.empty() && result.refusals.empty()) {
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
  if (v.bound_mm > settings.design.tolerance_mm) {
    const auto worst = std::max_element(v.strip_bound_mm.begin(), v.strip_bound_mm.end());
    const std::string strip =
        worst == v.strip_bound_mm.end()
            ? "design"
            : result.strips[static_cast<std::size_t>(worst - v.strip_bound_mm.begin())].id;
    const Eigen::Vector3d& at = v.deviation.at;
    result.refusals.push_back({say(Saying::kStripAt, {strip, at.x(), at.y(), at.z()}), "", Limit::kDeviation,
                               v.bound_mm, settings.design.tolerance_mm});
    result.refusals.back().capped = v.capped;
    result.refusals.back().at = at;
  }
  // Without strips all is uncut: what stands before says why.
  if (v.uncut_share() > settings.design.max_uncut_share &&
      !(result.program.strips.empty() && !result.refusals.empty())) {
    result.refusals.push_back(
        {"design", "", Limit::kUncutShare, 100 * v.uncut_share(), 100 * settings.design.max_uncut_share});
  }
}

// Ribs follow the facets of the file, not the surface that they stand for.
void warn_of_facets(const surface::DesignSurface& design, const Settings& settings, PlanResult& result) {
  const double chord =
      mesh_chord_mm(design.mesh, crease_limits(settings.design.tolerance_mm, settings.blade));
  const double allowed = settings.fit.deviation_share * settings.design.tolerance_mm;
  if (chord <= allowed) return;
  result.warnings.push_back(say(Saying::kFacets, {chord, allowed}));
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
    result.warnings.push_back(say(Saying::kOfDesign, {budget_text(verdict)}));
    return;
  }
  result.refusals.push_back(
      {"design", "", Limit::kBudget, verdict.budget_mm, verdict.tolerance_mm, needed_text(verdict)});
  result.program.verification.status = VerificationStatus::kRefused;
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

// Verifies a swept plan in full.
void plan_swept(const SweptPlan& swept, const surface::DesignSurface& design, const Settings& settings,
                const PlanHooks& hooks, Stopwatch& watch, PlanResult& result) {
  result.program.strips.clear();
  result.strips.clear();
  result.warnings.clear();
  result.spacing_mm = 0;
  for (const StripPlan& strip : swept.strips) {
    const auto gaps = static_cast<double>(strip.ribs.size() - 1);
    result.spacing_mm =
        std::max(result.spacing_mm, (strip.ribs.back().offset_mm - strip.ribs.front().offset_mm) / gaps);
  }
  result.refusals = swept.refusals;
  pose_and_verify(swept.strips, design, settings, hooks, watch, result);
  judge(settings, result);
}

// Looks at each of a plan's strips by itself, more coarsely than in full: where it leaves the design and what
// of its motion is refused.
PlanResult plan_alone(const SweptPlan& swept, const surface::DesignSurface& design, const Settings& settings,
                      const PlanHooks& hooks, const PlanResult& result) {
  PlanResult alone;
  alone.program = result.program;
  pose_strips(swept.strips, settings, hooks, MotionLook::kCoarse, alone);
  constexpr double kCoarser = 2;
  VerifyOptions options = verify_options(alone.program.settings, hooks.backend);
  options.sample_mm *= kCoarser;
  options.cut_only = true;
  take_report(measure(alone.program, {}, design, options), alone);
  judge(settings, alone);
  return alone;
}

// The refused plan that comes nearest to one that passes: what is shown when none does.
class Nearest {
 public:
  void offer(const SweptPlan& swept, const PlanResult* verified) {
    const Nearness rank = nearness(swept, verified);
    if (rank_ && !(rank < *rank_)) return;
    rank_ = rank;
    swept_ = swept;
    verified_ = verified ? std::optional(*verified) : std::nullopt;
  }

  // The plan that was offered, without strips where none was.
  [[nodiscard]] const SweptPlan& swept() const { return swept_; }

  void show(const surface::DesignSurface& design, const Settings& settings, const PlanHooks& hooks,
            Stopwatch& watch, PlanResult& result) {
    PlanResult shown = verified_ ? std::move(*verified_) : result;
    if (!verified_ && rank_) plan_swept(swept_, design, settings, hooks, watch, shown);
    if (!rank_) {
      // Without anything to try no part was found, which the judgement says.
      if (waste_side(design.mesh, settings.design.keep) == 0)
        shown.refusals = {leaning_refusal(design, settings)};
      pose_and_verify({}, design, settings, hooks, watch, shown);
      judge(settings, shown);
    }
    shown.decisions = std::move(result.decisions);
    shown.times = std::move(result.times);
    result = std::move(shown);
  }

 private:
  // Nothing is tried where `keep` does not tell the waste's side.
  static Refusal leaning_refusal(const surface::DesignSurface& design, const Settings& settings) {
    const bool closed = design.health.closed && !settings.design.facing;
    return {"design",
            "",
            Limit::kLean,
            0,
            kLeastLean,
            closed ? say(Saying::kClosed, {}) : say(Saying::kUpright, {name(settings.design.keep)})};
  }

  std::optional<Nearness> rank_;
  SweptPlan swept_;
  std::optional<PlanResult> verified_;
};

// What the strips of a plan melt, each by the speeds of its own motion; none where it has none.
std::vector<std::shared_ptr<const SweptBands>> bands_of(const SweptPlan& swept, const Settings& settings) {
  std::vector<std::shared_ptr<const SweptBands>> bands(swept.strips.size());
  tbb::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t i) {
    BladeSpeeds speeds(move_blade(swept.strips[i], settings).poses);
    if (!speeds.empty()) bands[i] = std::make_shared<SweptBands>(settings.blade, std::move(speeds));
  });
  gpu::stop_point();
  return bands;
}

SweepVerdict verdict_on(const PlanResult& looked) {
  return {looked.refusals.empty(), failed_strips(looked), too_far_strips(looked),
          deviations_with_sag_mm(looked)};
}

// Each strip as one swept family: the first such plan that passes is taken. `hooks` are told of what is
// looked at in full, `progress` of the rest. Returns the plan that is shown.
SweptPlan try_sweeps(const surface::DesignSurface& design, const Settings& settings, const PlanHooks& hooks,
                     PlanProgress& progress, Stopwatch& watch, PlanResult& result) {
  std::optional<SweptPlan> taken;
  Nearest nearest;
  const auto judged = [&](const SweptPlan& swept) -> SweepVerdict {
    watch.lap("sweep");
    PlanResult other = result;
    const bool whole = swept.refusals.empty();
    if (whole) plan_swept(swept, design, settings, hooks, watch, other);
    result.decisions.push_back(decision_of(swept, other));
    if (!whole || !other.refusals.empty()) {
      nearest.offer(swept, whole ? &other : nullptr);
      progress.next_try();
      return whole ? verdict_on(other) : SweepVerdict{};
    }
    other.decisions = std::move(result.decisions);
    other.times = std::move(result.times);
    result = std::move(other);
    for (Decision& d : result.decisions) d.taken = &d == &result.decisions.back();
    taken = swept;
    return {true, {}};
  };
  const auto judged_alone = [&](const SweptPlan& swept) -> SweepVerdict {
    watch.lap("sweep");
    const PlanResult alone = plan_alone(swept, design, settings, hooks, result);
    watch.lap("look");
    result.decisions.push_back(decision_of(swept, alone));
    result.decisions.back().alone = true;
    return verdict_on(alone);
  };
  const auto watched = [&] { progress.fitted(); };
  BandsOfSweep bands;
  if (settings.blade.melt.by_speed())
    bands = [&](const SweptPlan& swept) { return bands_of(swept, settings); };
  std::vector<PlanesTried> ranking;
  try {
    ranking = search_sweeps(design, settings, {judged, judged_alone}, watched, bands);
  } catch (const surface::FanError& error) {
    throw Error(ErrorKind::kNotCuttable, error.what());
  }
  if (!taken) nearest.show(design, settings, hooks, watch, result);
  result.ranking = std::move(ranking);
  return taken.value_or(nearest.swept());
}

// One face of a design as a design of its own.
surface::DesignSurface face_of(const surface::DesignSurface& design, surface::TriangleMesh mesh) {
  surface::DesignSurface face;
  face.units = design.units;
  face.scale_to_mm = design.scale_to_mm;
  face.up = design.up;
  face.health.vertices = mesh.vertices().size();
  face.health.triangles = mesh.triangles().size();
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : mesh.vertices()) box.extend(p);
  face.health.bbox_mm = {box.min(), box.max()};
  const MeshView view{mesh.vertices(), mesh.triangles()};
  for (std::size_t f = 0; f < mesh.triangles().size(); ++f)
    face.health.area_mm2 += facet(view, static_cast<int>(f)).area();
  face.mesh = std::move(mesh);
  return face;
}

// A face's plan behind those of the faces before, its parts named on from theirs.
void append(SweptPlan& whole, SweptPlan face) {
  const std::size_t before = whole.fits.size();
  const auto renamed = [&](const std::string& id) {
    constexpr std::size_t kLetter = 1;
    return fmt::format("S{:03}", before + std::stoul(id.substr(kLetter)));
  };
  if (before == 0) whole.planes = face.planes;
  for (StripPlan& strip : face.strips) {
    strip.id = renamed(strip.id);
    whole.strips.push_back(std::move(strip));
  }
  for (Refusal& refusal : face.refusals) {
    refusal.strip = renamed(refusal.strip);
    whole.refusals.push_back(std::move(refusal));
  }
  whole.parts += face.parts;
  whole.fits.insert(whole.fits.end(), face.fits.begin(), face.fits.end());
  whole.deviation_mm = std::max(whole.deviation_mm, face.deviation_mm);
  whole.sag_mm = std::max(whole.sag_mm, face.sag_mm);
}

// A design with creases: no blade goes over one within the tolerance, so each of the faces that meet there is
// planned as a design of its own, and the whole is measured then.
SweptPlan try_faces(const surface::DesignSurface& design, std::vector<surface::TriangleMesh> meshes,
                    const Settings& settings, const PlanHooks& hooks, PlanProgress& progress,
                    Stopwatch& watch, PlanResult& result) {
  Settings own = settings;
  // The whole tells the waste's side: a face may stand upright.
  if (const double side = waste_side(design.mesh, settings.design.keep); side != 0)
    own.design.keep = side > 0 ? Keep::kBack : Keep::kFront;
  SweptPlan whole;
  whole.way = SweepWay::kFaces;
  for (surface::TriangleMesh& mesh : meshes) {
    PlanResult face;
    face.program = result.program;
    const surface::DesignSurface alone = face_of(design, std::move(mesh));
    const std::size_t strips = whole.strips.size();
    append(whole, try_sweeps(alone, own, hooks, progress, watch, face));
    result.faces.push_back({{strips, whole.strips.size() - strips},
                            {result.decisions.size(), face.decisions.size()},
                            {result.ranking.size(), face.ranking.size()},
                            strips_lower_bound(alone.health.area_mm2, settings)});
    for (Decision& d : face.decisions) d.taken = false;
    std::move(face.decisions.begin(), face.decisions.end(), std::back_inserter(result.decisions));
    std::move(face.ranking.begin(), face.ranking.end(), std::back_inserter(result.ranking));
  }
  plan_swept(whole, design, settings, hooks, watch, result);
  result.decisions.push_back(decision_of(whole, result));
  result.decisions.back().taken = result.refusals.empty();
  return whole;
}

void try_design(const surface::DesignSurface& design, const Settings& settings, const PlanHooks& hooks,
                PlanProgress& progress, Stopwatch& watch, PlanResult& result) {
  std::vector<surface::TriangleMesh> faces =
      surface::smooth_faces(design.mesh, crease_limits(settings.design.tolerance_mm, settings.blade));
  const SweptPlan shown = faces.size() == 1
                              ? try_sweeps(design, settings, hooks, progress, watch, result)
                              : try_faces(design, std::move(faces), settings, hooks, progress, watch, result);
  if (!result.refusals.empty()) return;
  tbb::parallel_for(std::size_t{0}, result.strips.size(), [&](std::size_t i) {
    result.strips[i].blades = try_other_blades(shown.strips[i], settings);
  });
  gpu::stop_point();
}

// What the program says of itself, once all is measured.
void conclude(const surface::DesignSurface& design, PlanResult& result) {
  Program& program = result.program;
  const Settings& settings = program.settings;
  Verification& v = program.verification;
  v.tolerance_mm = settings.design.tolerance_mm;
  v.deviation_mm = result.verification.deviation;
  v.uncut_mm2 = result.verification.uncut_mm2;
  v.budget_mm = error_budget(design, program, pose_errors(result.strips));
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
  judge_budget(settings, result);
}

}  // namespace

std::string clamp_coordinate_name(std::size_t coordinate) {
  constexpr std::array<const char*, 6> kNames{"along_a", "across_a", "turn_a",
                                              "along_b", "across_b", "turn_b"};
  return kNames.at(coordinate);
}

PlanResult plan(const surface::DesignSurface& design, const Settings& given, const PlanHooks& hooks) {
  const Settings settings = with_true_lengths(given);
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
  result.strips_lower_bound = fewest;
  warn_of_facets(design, settings, result);
  conclude(design, result);
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
  judge(result.program.settings, result);
  conclude(design, result);
}

}  // namespace hotblade::pipeline
