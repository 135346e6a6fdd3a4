#include "pipeline/plan/strip_looks.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <mutex>
#include <string>
#include <utility>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/planned_ribs.hpp"
#include "pipeline/sayings/saying.hpp"
#include "pipeline/verify/blade_speeds.hpp"
#include "pipeline/verify/foam_share.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

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

PlannedStrip planned_strip(const StripPlan& strip, const Settings& settings, MotionLook look) {
  PosedStrip posed{strip, move_blade(strip, settings, look)};
  posed.strip.design_to_cell.p.z() += posed.motion.raise_mm;
  PlannedStrip planned;
  planned.facts = facts_of(posed, settings);
  planned.refusals = std::move(posed.motion.refusals);
  planned.warnings = std::move(posed.motion.warnings);
  warn_of_slow_melt(posed.strip.id, posed.motion.poses, settings, planned.warnings);
  planned.strip = make_strip(posed.strip, std::move(posed.motion.poses), settings.design.tolerance_mm);
  planned.facts.foam_kept_share = foam_kept_share(planned.strip);
  return planned;
}

// Wherever a text names a strip or one of its ribs, it names another.
void rename(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

void rename(std::vector<Refusal>& refusals, const std::string& from, const std::string& to) {
  for (Refusal& refusal : refusals) {
    for (std::string* text : {&refusal.strip, &refusal.rib, &refusal.note}) rename(*text, from, to);
    for (std::string& text : refusal.details) rename(text, from, to);
  }
}

void rename(PlannedStrip& planned, const std::string& to) {
  const std::string from = planned.strip.id;
  if (from == to) return;
  planned.strip.id = planned.facts.id = to;
  for (Rib& rib : planned.strip.ribs) rename(rib.id, from, to);
  rename(planned.refusals, from, to);
  for (std::string& text : planned.warnings) rename(text, from, to);
}

}  // namespace

void set_bands(const std::vector<BladePose>& poses, const Settings& settings, StripFacts& facts) {
  facts.band_min_mm = facts.band_max_mm = settings.blade.kerf_mm;
  if (!settings.blade.melt.by_speed()) return;
  const BladeSpeeds speeds(poses);
  const double feed = settings.motion.feed_mm_s;
  const auto [slowest, fastest] = speeds.empty() ? std::pair(feed, feed) : speeds.range();
  facts.band_min_mm = settings.blade.band_mm(fastest);
  facts.band_max_mm = settings.blade.band_mm(slowest);
}

std::vector<std::shared_ptr<const SweptBands>> bands_of(const std::vector<StripPlan>& strips,
                                                        const Settings& settings) {
  std::vector<std::shared_ptr<const SweptBands>> bands(strips.size());
  tbb::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t i) {
    BladeSpeeds speeds(move_blade(strips[i], settings).poses);
    if (!speeds.empty()) bands[i] = std::make_shared<SweptBands>(settings.blade, std::move(speeds));
  });
  gpu::stop_point();
  return bands;
}

void StripLooks::pose(const std::vector<StripPlan>& strips, const Settings& settings,
                      const std::function<void(double)>& posed) {
  std::vector<Looked> before = std::exchange(looked_, std::vector<Looked>(strips.size()));
  std::move(others_.begin(), others_.end(), std::back_inserter(before));
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < strips.size(); ++i) {
    const auto known = std::find_if(before.begin(), before.end(), [&](const Looked& looked) {
      return !looked.plan.ribs.empty() && same_blades(looked.plan, strips[i]);
    });
    if (known == before.end()) {
      changed.push_back(i);
      looked_[i].plan = strips[i];
      continue;
    }
    looked_[i] = std::move(*known);
    known->plan.ribs.clear();
    Looked& looked = looked_[i];
    rename(looked.branch, looked.plan.id, strips[i].id);
    rename(looked.planned, strips[i].id);
    looked.plan.id = strips[i].id;
    looked.planned.facts.joint_fit_mm = strips[i].joint_fit_mm;
    looked.planned.facts.seam = strips[i].seam_before;
  }
  std::erase_if(before, [](const Looked& looked) { return looked.plan.ribs.empty(); });
  others_ = look_ == MotionLook::kCoarse ? std::move(before) : std::vector<Looked>{};
  std::mutex telling;
  std::size_t told = strips.size() - changed.size();
  tbb::parallel_for(std::size_t{0}, changed.size(), [&](std::size_t k) {
    Looked& looked = looked_[changed[k]];
    looked.planned = planned_strip(looked.plan, settings, look_);
    const std::scoped_lock lock(telling);
    posed(static_cast<double>(++told) / static_cast<double>(strips.size()));
  });
  gpu::stop_point();
}

std::size_t StripLooks::fresh() const {
  return static_cast<std::size_t>(
      std::count_if(looked_.begin(), looked_.end(), [](const Looked& looked) { return !looked.measured; }));
}

void StripLooks::measure_fresh(const Program& like, const surface::DesignSurface& design,
                               const VerifyOptions& options) {
  Program program;
  program.settings = like.settings;
  program.blade = like.blade;
  std::vector<Looked*> fresh;
  for (Looked& looked : looked_) {
    if (looked.measured) continue;
    fresh.push_back(&looked);
    program.strips.push_back(std::move(looked.planned.strip));
  }
  if (fresh.empty()) return;
  VerifyOptions of_cut = options;
  of_cut.cut_only = true;
  const VerifyReport report = measure(program, {}, design, of_cut);
  const double sharpest = robot::max_curvature_per_mm(program.blade);
  tbb::parallel_for(std::size_t{0}, fresh.size(), [&](std::size_t i) {
    Looked& looked = *fresh[i];
    looked.planned.strip = std::move(program.strips[i]);
    looked.measured = true;
    looked.deviation_mm = report.strip_max_mm[i];
    looked.bound_mm = report.strip_bound_mm[i];
    looked.deviation_at = report.strip_max_at[i];
    if (look_ == MotionLook::kCoarse) {
      std::vector<BladePose>().swap(looked.planned.strip.poses);
      return;
    }
    const BranchReport branch =
        follow_branch(looked.planned.strip, {sharpest, options.min_margin, program.settings.machine.clamps});
    looked.bound_mm = std::max(
        looked.bound_mm, report.rows.with(branch.told_off, looked.planned.strip, i, program.blade.width_mm));
    if (!branch.held()) looked.branch = {branch_refusal(looked.planned.strip, branch)};
  });
  gpu::stop_point();
}

PlanResult StripLooks::known() const {
  PlanResult result;
  Deviation& worst = result.verification.deviation;
  for (const Looked& looked : looked_) {
    const PlannedStrip& planned = looked.planned;
    result.strips.push_back(planned.facts);
    result.strips.back().deviation_max_mm = looked.deviation_mm;
    result.strips.back().deviation_bound_mm = looked.bound_mm;
    result.verification.strip_max_mm.push_back(looked.deviation_mm);
    result.verification.strip_bound_mm.push_back(looked.bound_mm);
    result.verification.strip_max_at.push_back(looked.deviation_at);
    result.verification.bound_mm = std::max(result.verification.bound_mm, looked.bound_mm);
    if (looked.deviation_mm > worst.max) {
      worst.max = looked.deviation_mm;
      worst.at = looked.deviation_at;
    }
    result.refusals.insert(result.refusals.end(), planned.refusals.begin(), planned.refusals.end());
    result.warnings.insert(result.warnings.end(), planned.warnings.begin(), planned.warnings.end());
  }
  for (const Looked& looked : looked_)
    result.refusals.insert(result.refusals.end(), looked.branch.begin(), looked.branch.end());
  return result;
}

void StripLooks::give(PlanResult& result) {
  for (Looked& looked : looked_) {
    PlannedStrip& planned = looked.planned;
    result.program.strips.push_back(std::move(planned.strip));
    result.strips.push_back(planned.facts);
    result.refusals.insert(result.refusals.end(), planned.refusals.begin(), planned.refusals.end());
    result.warnings.insert(result.warnings.end(), planned.warnings.begin(), planned.warnings.end());
  }
}

void StripLooks::take_back(PlanResult& result) {
  const VerifyReport& found = result.verification;
  for (std::size_t i = 0; i < looked_.size(); ++i) {
    Looked& looked = looked_[i];
    looked.planned.strip = std::move(result.program.strips[i]);
    looked.measured = true;
    looked.deviation_mm = found.strip_max_mm[i];
    looked.bound_mm = found.strip_bound_mm[i];
    looked.deviation_at = found.strip_max_at[i];
    looked.branch.clear();
    if (!found.branches[i].held()) looked.branch = {branch_refusal(looked.planned.strip, found.branches[i])};
  }
  result.program.strips.clear();
}

}  // namespace hotblade::pipeline
