#include "pipeline/report/json/report_json.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "pipeline/settings/json_text.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/verdict.hpp"
#include "robot/arm/arm.hpp"

namespace hotblade::pipeline {

namespace {

using Json = nlohmann::ordered_json;
using robot::kDegree_rad;

nlohmann::ordered_json held_json(const HeldClamp& held) {
  return {{"arm", held.arm}, {"branch", held.branch}, {"flip", held.flip}, {"turns", held.turns}};
}

Json vector_json(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

// mm of shape change by each clamp coordinate of a rib; null where the blade is straight, and where the strip
// was looked at without its clamps' errors.
Json sensitivity_json(const MotionFacts& motion, std::size_t rib) {
  std::array<double, 6> mm;
  mm.fill(std::numeric_limits<double>::infinity());
  if (rib < motion.rib_sensitivity_mm.size()) mm = motion.rib_sensitivity_mm[rib];
  Json json;
  for (std::size_t i = 0; i < mm.size(); ++i) {
    json[clamp_coordinate_name(i)] = std::isfinite(mm[i]) ? Json(mm[i]) : Json();
  }
  return json;
}

// The blade's length and its neighbours in the list; null where nothing is known of them.
Json blades_json(const std::optional<BladeTrials>& trials) {
  if (!trials) return {};
  const auto trial_json = [](const BladeTrial& trial) -> Json {
    const bool stopped = trial.refusal.limit != Limit::kNone;
    return {{"length_mm", trial.length_mm},
            {"stopped_by", stopped ? Json(describe_amount(trial.refusal)) : Json()},
            {"sag_mm", stopped || !std::isfinite(trial.sag_mm) ? Json() : Json(trial.sag_mm)}};
  };
  return {{"chosen", trial_json(trials->chosen)},
          {"shorter", trials->shorter ? trial_json(*trials->shorter) : Json()},
          {"longer", trials->longer ? trial_json(*trials->longer) : Json()}};
}

Json strip_json(const StripFacts& f, const Strip& strip) {
  const auto weighed = [&](double mm) { return f.motion.clamps_weighed() ? Json(mm) : Json(); };
  Json ribs = Json::array();
  for (std::size_t i = 0; i < strip.ribs.size(); ++i) {
    const Rib& rib = strip.ribs[i];
    ribs.push_back({{"id", rib.id},
                    {"lambda_residual", rib.lambda_residual},
                    {"l2", rib.l2},
                    {"h1", rib.h1},
                    {"hausdorff_mm", rib.hausdorff_mm},
                    {"design_deviation_mm", rib.design_deviation_mm},
                    {"clamp_sensitivity_mm", sensitivity_json(f.motion, i)}});
  }
  Json json = {{"id", f.id},
               {"ribs", f.ribs},
               {"projected_ribs", f.projected_ribs},
               {"blade_length_mm", f.blade_length_mm},
               {"blade_trials", blades_json(f.blades)},
               {"deviation_max_mm", f.deviation_max_mm},
               {"deviation_bound_mm", f.deviation_bound_mm},
               {"rib_fit_max_mm", f.worst_fit_mm},
               {"bezier_fit_max_mm", f.worst_bezier_mm},
               {"seam_gap_max_mm", f.seam.gap_mm},
               {"seam_kink_max_deg", f.seam.kink_deg},
               {"lambda_residual_max", f.largest_lambda_residual},
               {"blade_radius_min_mm", f.smallest_radius_mm()},
               {"stability_margin_min", f.smallest_margin},
               {"clamp_clearance_min_mm", f.motion.smallest_clearance_mm},
               {"clamp_force_max_n", f.motion.largest_force_n},
               {"clamp_moment_max_n_mm", f.motion.largest_moment_n_mm},
               {"bending_stress_max_mpa", f.motion.largest_stress_mpa},
               {"droop_mm", f.motion.droop_mm},
               {"droop_error_mm", f.droop_error_mm},
               {"in_plane_sag_mm", f.motion.in_plane_sag_mm},
               {"clamp_error_mm", weighed(f.motion.clamp_error_mm)},
               {"margin_mm_min", weighed(f.motion.smallest_margin_mm())},
               {"snap_margin_mm_min", weighed(f.motion.smallest_fold_mm)},
               {"straight_margin_mm_min", weighed(f.motion.smallest_straight_mm)},
               {"duration_s", f.motion.duration_s},
               {"cut_s", f.motion.cut_s},
               {"feed_slowest_mm_s", f.motion.slowest_feed_mm_s},
               {"band_min_mm", f.band_min_mm},
               {"band_max_mm", f.band_max_mm},
               {"plane_turn_rad", f.plane_turn_rad},
               {"off_plane_mm", f.motion.off_plane_mm},
               {"stock_volume_mm3", f.stock_volume_mm3},
               {"foam_kept_share", f.foam_kept_share},
               {"plinth_mm", f.plinth_mm},
               {"stock_size_mm", vector_json(strip.block.size_mm)},
               {"poses", strip.poses.size()},
               {"rib_facts", ribs}};
  if (f.motion.jerk_s > 0) json["jerk_s"] = f.motion.jerk_s;
  if (strip.arms) json["arms"] = arms_json(*strip.arms);
  return json;
}

Json ranking_json(const std::vector<PlanesTried>& ranking) {
  Json list = Json::array();
  for (const PlanesTried& d : ranking) {
    Json axis, fit;
    if (d.planes.turns())
      axis = {{"point", vector_json(d.planes.centre())}, {"direction", vector_json(d.planes.axis())}};
    if (d.fit_mm) fit = *d.fit_mm;
    list.push_back({{"normal", vector_json(d.planes.normal(0))},
                    {"fan_axis", axis},
                    {"parts_along_sweep", d.along_sweep},
                    {"parts_along_ribs", d.along_ribs},
                    {"missed_mm", std::isfinite(d.missed_mm) ? Json(d.missed_mm) : Json()},
                    {"fit_mm", fit}});
    if (d.of_rows()) {
      list.back()["rows"] = {{"blocks_at_least", d.blocks},
                             {"strips", d.strips_in_rows > 0 ? Json(d.strips_in_rows) : Json()}};
    }
  }
  return list;
}

Json decisions_json(const std::vector<Decision>& decisions) {
  Json list = Json::array();
  for (const Decision& d : decisions) {
    Json fits = Json::array();
    for (const SweptFit& f : d.fits) {
      Json before;
      if (f.before) {
        before = {{"blade_length_mm", f.before->blade_length_mm},
                  {"fit_mm", f.before->fit_mm},
                  {"clamp_error_mm", f.before->clamps_mm}};
      }
      fits.push_back({{"coefficients", f.coefficients},
                      {"calm", f.calm},
                      {"blade_length_mm", f.blade_length_mm},
                      {"fit_mm", std::isfinite(f.fit_mm) ? Json(f.fit_mm) : Json()},
                      {"clamp_error_mm", f.clamps_mm > 0 ? Json(f.clamps_mm) : Json()},
                      {"before_steadying", before}});
    }
    list.push_back({{"way", name(d.way)},
                    {"normal", vector_json(d.normal)},
                    {"fan", d.fan},
                    {"fits", fits},
                    {"strips", d.strips},
                    {"ribs", d.ribs},
                    {"fit_mm", d.fit_mm},
                    {"deviation_mm", d.deviation_mm},
                    {"passed", d.passed},
                    {"taken", d.taken},
                    {"alone", d.alone},
                    {"why", d.why()}});
  }
  return list;
}

Json faces_json(const PlanResult& result) {
  const auto range = [](const FacePlanned::Range& r) { return Json{{"first", r.first}, {"count", r.count}}; };
  Json list = Json::array();
  for (const FacePlanned& face : result.faces) {
    list.push_back({{"strips", range(face.strips)},
                    {"decisions", range(face.decisions)},
                    {"directions", range(face.ranking)},
                    {"strips_lower_bound", face.strips_lower_bound}});
  }
  return list;
}

// What to buy, with the strip of each piece; sizes longest first, cuts in the order in which they are made.
Json foam_json(const Nesting& foam, const Program& program) {
  constexpr double kPerM3 = 1e9;
  Json blocks = Json::array();
  for (const BoughtBlock& block : foam.blocks) {
    Json pieces = Json::array(), cuts = Json::array();
    for (const NestedPiece& p : block.pieces)
      pieces.push_back(
          {{"strip", program.strips.at(p.piece).id}, {"at_mm", p.box.at}, {"size_mm", p.box.size}});
    for (const SawCut& cut : block.cuts)
      cuts.push_back(
          {{"of", {{"at_mm", cut.of.at}, {"size_mm", cut.of.size}}}, {"axis", cut.axis}, {"at_mm", cut.at}});
    blocks.push_back({{"size_mm", block.size}, {"pieces", pieces}, {"cuts", cuts}});
  }
  return {{"bought_m3", foam.bought_mm3 / kPerM3},
          {"blocks_m3", foam.pieces_mm3 / kPerM3},
          {"bought_apart_m3", foam.apart_mm3 / kPerM3},
          {"bought", blocks}};
}

Json narrowed_json(const TriedRemedy& remedy) {
  if (!remedy.narrowed) return {};
  return {{"passes", remedy.narrowed->passes},
          {"fails", remedy.narrowed->fails},
          {"unit", remedy.narrowed->unit}};
}

}  // namespace

nlohmann::ordered_json to_json(const Refusal& r) {
  return {{"strip", r.strip},       {"rib", r.rib},
          {"limit", limit_text(r)}, {"value", r.value},
          {"capped", r.capped},     {"bound", r.bound},
          {"unit", unit(r)},        {"hint", note(r)},
          {"place", r.place},       {"at", r.at ? vector_json(*r.at) : Json()},
          {"details", r.details},   {"message", describe(r)}};
}

nlohmann::ordered_json to_json(const std::vector<TriedRemedy>& remedies) {
  auto json = nlohmann::ordered_json::array();
  for (const TriedRemedy& m : remedies) {
    json.push_back({{"set", m.assignments},
                    {"without", m.without},
                    {"because", m.why},
                    {"deviation_mm", m.deviation_mm},
                    {"tolerance_mm", m.tolerance_mm},
                    {"strips", m.strips},
                    {"verdict", m.verdict},
                    {"narrowed", narrowed_json(m)}});
  }
  return json;
}

nlohmann::ordered_json arms_json(const StripArms& arms) {
  nlohmann::ordered_json nearest = nlohmann::ordered_json::object();
  for (const StripArms::NearestPair& pair : arms.nearest_mm)
    nearest[pair.kind] = {{"mm", pair.mm}, {"t", pair.t}};
  nlohmann::ordered_json json = {{"a", held_json(arms.a)},    {"b", held_json(arms.b)},
                                 {"raise_mm", arms.raise_mm}, {"dx_mm", arms.dx_mm},
                                 {"dy_mm", arms.dy_mm},       {"yaw_deg", arms.yaw_rad / kDegree_rad}};
  if (arms.reach)
    json["reach"] = {{"share", arms.reach->value}, {"arm", arms.reach->arm}, {"t", arms.reach->t}};
  json["joint_margin"] = {{"deg", arms.joint_margin_rad.value / kDegree_rad},
                          {"arm", arms.joint_margin_rad.arm},
                          {"joint", arms.joint_margin_rad.joint},
                          {"t", arms.joint_margin_rad.t}};
  json["wrist"] = {
      {"deg", arms.wrist_rad.value / kDegree_rad}, {"arm", arms.wrist_rad.arm}, {"t", arms.wrist_rad.t}};
  json["nearest"] = nearest;
  json["added_s"] = {{"jerk", arms.jerk_s}, {"joints", arms.joints_s}};
  return json;
}

std::string report_json(const PlanResult& result, const std::string& program_sha256) {
  const Verification& v = result.program.verification;
  Json report;
  report["format"] = "hotblade-report";
  report["version"] = 1;
  report["created_by"] = result.program.created_by;
  report["status"] = name(v.status);
  report["verdict"] = to_json(verdict_of(result.program));
  report["design"] = {{"file", result.program.design.file},
                      {"sha256", result.program.design.sha256},
                      {"area_mm2", result.verification.area_mm2}};
  report["program_sha256"] = program_sha256.empty() ? Json() : Json(program_sha256);
  report["tolerance_mm"] = v.tolerance_mm;
  const Deviation& d = v.deviation_mm;
  report["deviation_mm"] = {{"max", d.max},
                            {"p99", d.p99},
                            {"rms", d.rms},
                            {"mean", d.mean},
                            {"at", vector_json(d.at)},
                            {"bound", result.verification.bound_mm},
                            {"capped", result.verification.capped}};
  report["percentiles_mm"] = Json::array();
  for (const auto& [percent, mm] : result.verification.percentiles_mm) {
    report["percentiles_mm"].push_back({{"percent", percent}, {"mm", mm}});
  }
  const DeviationHistogram& histogram = result.verification.histogram;
  report["histogram"] = {
      {"bin_mm", histogram.bin_mm}, {"areas_mm2", histogram.areas_mm2}, {"beyond_mm2", histogram.beyond_mm2}};
  report["uncut_mm2"] = v.uncut_mm2;
  report["uncut_share"] = result.verification.uncut_share();
  report["samples"] = {{"cut", result.verification.cut_samples},
                       {"beyond_design", result.verification.beyond_samples},
                       {"design", result.verification.design_samples}};
  report["budget_mm"] = Json::object();
  for (const auto& [name, mm] : v.budget_mm) report["budget_mm"][name] = mm;
  report["budget_sum_mm"] = budget_sum_mm(v.budget_mm);
  report["rib_spacing_mm"] = result.spacing_mm;
  report["strips_lower_bound"] = result.strips_lower_bound;
  report["decisions"] = decisions_json(result.decisions);
  report["faces"] = faces_json(result);
  report["refusals"] = Json::array();
  for (const Refusal& r : result.refusals) report["refusals"].push_back(to_json(r));
  report["remedies"] = to_json(result.remedies);
  report["overrides"] = result.program.overrides;
  report["warnings"] = result.warnings;
  report["not_checked"] = v.not_checked;
  report["directions"] = ranking_json(result.ranking);
  if (result.program.cell)
    report["cell"] = {{"name", result.program.cell->name}, {"sha256", result.program.cell->sha256}};
  if (result.foam) report["foam"] = foam_json(*result.foam, result.program);
  report["strips"] = Json::array();
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    report["strips"].push_back(strip_json(result.strips[i], result.program.strips[i]));
  }
  report["settings"] = to_json(result.program.settings);
  return json_text(report, 2) + "\n";
}

}  // namespace hotblade::pipeline
