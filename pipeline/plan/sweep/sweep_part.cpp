#include "pipeline/plan/sweep/sweep_part.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/motion/blade.hpp"
#include "pipeline/plan/sweep/moved_surface.hpp"
#include "pipeline/plan/sweep/sweep_block.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double rib_length(const SweepFitReport& fit) {
  return 2 * std::max(-fit.arc_low_mm, fit.arc_high_mm);
}

Vector3d sorted(Vector3d size) {
  std::sort(size.begin(), size.end());
  return size;
}

}  // namespace

SweepEffort cheap_effort() {
  return {5, 10, 45, {2, 8}, 15, 1, false, {}, true};
}

SweepEffort close_effort() {
  return {7, 16, 35, {2, 4, 8}, 15, 1, true};
}

SweepEffort final_effort(int coefficients, double calm, const Steadying& steadying) {
  return {coefficients, coefficients > 10 ? 48 : 40, 20, {2, 4, 8, 16}, 20, calm, false, steadying};
}

double PartFitter::clear_mm() const {
  constexpr double kReserve = 1.05, kMoreMm = 1;
  return settings_.stock.border_mm + kReserve * settings_.stock.clearance_mm + kMoreMm;
}

double PartFitter::longest_edge_mm() const {
  const auto& stock = settings_.stock.max_size_mm;
  return *std::max_element(stock.begin(), stock.end()) - 2 * settings_.stock.border_mm;
}

double PartFitter::longest_rib_mm() const {
  return settings_.blade.free_lengths_mm.back() - 2 * clear_mm();
}

// The shortest blade that reaches over ribs of this length; 0: none does.
double PartFitter::blade_for(double rib_mm) const {
  for (const double length : settings_.blade.free_lengths_mm) {
    if (length >= rib_mm + 2 * clear_mm()) return length;
  }
  return 0;
}

// Why no blade of the list reaches over a rib: where none could reach over any, it is the clearance.
Refusal PartFitter::unreached(double rib_mm) const {
  if (longest_rib_mm() > 0) return {"", "", Limit::kRibLength, rib_mm, longest_rib_mm()};
  const double left = 0.5 * (settings_.blade.free_lengths_mm.back() - rib_mm) - settings_.stock.border_mm;
  return {"", "", Limit::kClampClearance, std::max(0.0, left), clear_mm() - settings_.stock.border_mm};
}

// What no fit can mend.
std::optional<Refusal> PartFitter::refusal_of(const SweepData& data) const {
  constexpr double kDegrees = 57.29577951308232;
  if (data.turn_rad > kMostTurnRad)
    return Refusal{"", "", Limit::kFacing, kDegrees * data.turn_rad, kDegrees * kMostTurnRad};
  if (data.steepest_rad > kMaxSlopeRad)
    return Refusal{"", "", Limit::kSlope, kDegrees * data.steepest_rad, kDegrees * kMaxSlopeRad};
  if (data.sections.empty()) return Refusal{"", "", Limit::kStrips, 0, 1};
  if (data.gap)
    return Refusal{"", "", Limit::kGap, data.gap->width_mm(),
                   settings_.blade.band_mm(settings_.motion.feed_mm_s)};
  const auto& most = settings_.stock.max_size_mm;
  const Vector3d size = stock_for(data, settings_.stock), held = sorted({most[0], most[1], most[2]});
  for (Eigen::Index i = 2; i >= 0; --i) {
    if (size[i] > held[i]) return Refusal{"", "", Limit::kBlockEdge, size[i], held[i]};
  }
  return std::nullopt;
}

// By how much a part is too much for one strip.
double PartFitter::cost_of(const SweepData& data) const {
  const auto& most = settings_.stock.max_size_mm;
  const Vector3d size = stock_for(data, settings_.stock), held = sorted({most[0], most[1], most[2]});
  UnfollowedPart part;
  part.empty = data.sections.empty() && data.followable();
  part.turn_rad = std::max(0.0, data.turn_rad - kMostTurnRad);
  part.slope_rad = std::max(0.0, data.steepest_rad - kMaxSlopeRad);
  part.gap_mm = data.gap ? data.gap->width_mm() : 0;
  part.block_mm = (size - held).cwiseMax(0).sum();
  part.rib_mm = std::max(0.0, data.high.x() - data.low.x() - longest_rib_mm());
  return cost_mm(part);
}

SweepFitOptions PartFitter::options_for(const SweepData& data, const SweepEffort& effort) const {
  SweepFitOptions options;
  options.coefficients = effort.coefficients;
  options.exponents = effort.exponents;
  options.most_iterations = effort.most_iterations;
  options.calm = effort.calm;
  options.clamp_pull = {settings_.machine.clamp_error_mm, settings_.machine.clamp_error_rad,
                        effort.steadying.weight};
  options.turn_planes = effort.turn_planes && !data.axes.planes.turns();
  options.over_first_mm = over_first_mm(data);
  options.over_last_mm = over_last_mm(data);
  // A blade that is made steady bends at its free ends, and goes on so past the first and the last section.
  constexpr double kRadiusReserve = 1.06, kSteadyReserve = 1.2;
  const double reserve = effort.steadying.weight > 0 ? kSteadyReserve : kRadiusReserve;
  options.smallest_radius_mm = reserve / max_curvature_per_mm(settings_.blade);
  options.block = block_in_planes(data, settings_.stock, clear_mm() - settings_.stock.border_mm);
  return options;
}

PartFitter::MovedPart PartFitter::moved_of(const SweepPart& part, const SweepEffort& effort,
                                           const SweepSag* sag) const {
  const SweepSectionOptions options =
      section_options(settings_, part.seams, effort.sections, effort.sample_mm, sag, part.bands.get());
  // A gap may be narrower than the few are apart.
  const bool of_few = effort.of_few && part.surface->few && !options.gap_mm;
  return std::make_shared<const MovedSurface>(of_few ? *part.surface->few : *part.surface, part.axes,
                                              options);
}

SweepData PartFitter::sections_of(const MovedSurface& moved, const SweepEffort& effort) const {
  SweepSectionOptions options =
      section_options(settings_, {}, effort.sections, effort.sample_mm, nullptr, nullptr);
  options.if_followable = true;
  return sweep_sections(moved, options);
}

PartFit PartFitter::measured(const SweepData& data) const {
  PartFit fit;
  if (!data.sections.empty() || !data.followable()) {
    fit.extent = {Vector2d(data.first_mm, data.low.x()), Vector2d(data.last_mm, data.high.x())};
    fit.height_mm = 0.5 * (data.low.y() + data.high.y());
    fit.turn_rad = data.turn_rad;
    fit.gap = data.gap;
  }
  const auto& most = settings_.stock.max_size_mm;
  fit.stock_share =
      stock_for(data, settings_.stock).cwiseQuotient(sorted({most[0], most[1], most[2]})).maxCoeff();
  fit.refusal = refusal_of(data);
  fit.cost_mm = cost_of(data);
  return fit;
}

PartFit PartFitter::measured(const SweepPart& part) const {
  const SweepData data = sections_of(*moved_of(part, cheap_effort(), nullptr), cheap_effort());
  PartFit fit = measured(data);
  const double rib_mm = data.high.x() - data.low.x();
  if (fit.holds() && blade_for(rib_mm) == 0) fit.refusal = unreached(rib_mm);
  return fit;
}

PartFit PartFitter::fit(const SweepPart& part, const SweepEffort& effort, const PartFit* start) const {
  MovedPart moved;
  return fit(part, effort, start, moved);
}

PartFit PartFitter::fit(const SweepPart& part, const SweepEffort& effort, const PartFit* start,
                        MovedPart& moved) const {
  watch_();
  // Fans are not level, and not planned against their weight.
  const bool weighed = start && start->sag && start->sag->stable() && !part.axes.planes.turns();
  const std::shared_ptr<const SweepSag> formed_by = weighed ? start->sag : nullptr;
  moved = moved_of(part, effort, formed_by.get());
  const SweepData data = sections_of(*moved, effort);
  PartFit fit = measured(data);
  fit.formed_by = formed_by;
  if (!fit.holds()) return fit;
  SweepFitOptions options = options_for(data, effort);
  // The rib's length is not known before it is fitted: its width first, then what the fit says.
  const SweepFamily* from = start && start->sag ? &start->family : nullptr;
  double rib = from ? rib_length(*start) : data.high.x() - data.low.x();
  constexpr int kLooks = 4;
  // A clamp that comes so far into the block's clearance pulls at the fit: a longer blade may serve better.
  constexpr double kPulls_mm = 0.05;
  const auto blade_over = [&](double rib_mm) {
    const double shortest = blade_for(rib_mm);
    return shortest == 0 ? 0 : std::max(shortest, effort.steadying.blade_mm);
  };
  bool needed = true;  // the fit so far is too long for its blade, or there is none
  for (int look = 0; look < kLooks; ++look) {
    const double blade = blade_over(rib);
    if (blade == 0) {
      fit.refusal = unreached(rib);
      return fit;
    }
    if (look > 0 && blade <= options.blade_length_mm) break;
    options.blade_length_mm = blade;
    PartFit tried = fit;
    static_cast<SweepFitReport&>(tried) = fit_sweep(data, options, from);
    tried.blade_length_mm = blade;
    weigh(tried, part.axes, {blade, 0.5 * blade}, data);
    tried.cost_mm = cost_of(tried, part.axes.planes.turns());
    if (!needed && !(tried.cost_mm < fit.cost_mm)) break;
    fit = std::move(tried);
    from = &fit.family;
    rib = rib_length(fit);
    needed = blade_over(rib) != blade;
    if (!needed && fit.clamp_depth_mm > kPulls_mm && blade < settings_.blade.free_lengths_mm.back())
      rib = std::max(rib, blade - 2 * clear_mm() + 1);
  }
  return fit;
}

void PartFitter::weigh(PartFit& fit, const RibAxes& axes, const SweepBlade& blade,
                       const SweepData& data) const {
  fit.sag = std::make_shared<SweepSag>(fit.family, axes, blade, settings_.blade);
  fit.margin = fit.sag->smallest_margin();
  fit.sag_mm = fit.sag->moved_mm(fit.arc_low_mm, fit.arc_high_mm, data.steepest_rad);
}

double PartFitter::cost_of(const PartFit& fit, bool turns) const {
  FollowedPart part;
  part.deviation_mm = fit.max_mm;
  part.sag_mm = fit.sag_mm;
  part.unknown_share = robot::kSagUnknownShare + (turns ? 1 : 0);
  part.margin = fit.margin;
  part.least_margin = settings_.blade.min_margin;
  part.clamp_depth_mm = fit.clamp_depth_mm;
  part.radius_mm = fit.smallest_radius_mm;
  part.least_radius_mm = 1 / max_curvature_per_mm(settings_.blade);
  part.tolerance_mm = settings_.design.tolerance_mm;
  return cost_mm(part);
}

// A strip whose blade is not the one that its sections were moved for is fitted once more.
SweptStrip PartFitter::strip_of(const SweepPart& part, const SweepEffort& effort, PartFit& fit,
                                MovedPart moved) const {
  constexpr int kLooks = 3;
  constexpr double kSameBladeMm = 5;
  SweptStrip made;
  for (int look = 0; look < kLooks; ++look) {
    made = make_swept_strip(*moved, fit, effort.steadying.blade_mm, settings_);
    if (!made.strip || part.axes.planes.turns()) return made;
    const SweepBlade was = fit.formed_by ? fit.formed_by->blade() : SweepBlade{};
    if (std::abs(was.length_mm - made.blade.length_mm) <= kSameBladeMm &&
        std::abs(was.before_mm - made.blade.before_mm) <= kSameBladeMm)
      return made;
    PartFit start = fit;
    start.sag = std::make_shared<SweepSag>(fit.family, part.axes, made.blade, settings_.blade);
    PartFit again = this->fit(part, effort, &start, moved);
    if (!again.holds()) return made;
    fit = std::move(again);
  }
  return made;
}

PartPlan PartFitter::met(const MovedSurface& moved, const JointPart& joint, const SweepFamily& together,
                         const PartPlan& own) const {
  const RibAxes& axes = moved.axes();
  // The last of these closes a fifth of a gap: less is none that could be told from the strip's own.
  constexpr std::array<double, 3> kShares{1, 0.5, 0.2};
  for (const double share : kShares) {
    PartPlan plan = own;
    SweepFamily family = together;
    family.coefficients = share * together.coefficients + (1 - share) * own.fit.family.coefficients;
    static_cast<SweepFitReport&>(plan.fit) = measured_family(joint.data, joint.options, family);
    weigh(plan.fit, axes, {plan.fit.blade_length_mm, 0.5 * plan.fit.blade_length_mm}, joint.data);
    plan.fit.cost_mm = cost_of(plan.fit, axes.planes.turns());
    SweptStrip made = make_swept_strip(moved, plan.fit, plan.steadying.blade_mm, settings_);
    if (!made.strip) continue;
    plan.strip = std::move(made.strip);
    plan.fold_mm = fold_of(plan);
    if (!(plan.fold_mm >= std::min(own.fold_mm, least_fold_mm(plan)))) continue;
    plan.strip->joint_fit_mm = std::max(0.0, plan.fit.max_mm - own.fit.max_mm);
    return plan;
  }
  return own;
}

namespace {

// Which parts a joint fit moves, and which it holds for them.
struct Moved {
  std::vector<bool> moves, holds;
};

// Parts that are not settled move, and their neighbours with them; the neighbours of these are held.
Moved moved_parts(const std::vector<bool>& settled, const std::vector<PartSeam>& seams) {
  const std::size_t count = settled.size();
  Moved moved{std::vector<bool>(count, false), std::vector<bool>(count, false)};
  for (std::size_t i = 0; i < count; ++i) moved.moves[i] = !settled[i];
  const auto beside = [&](const std::vector<bool>& some) {
    std::vector<bool> all(count, false);
    for (const PartSeam& seam : seams) {
      if (some[seam.first]) all[seam.second] = true;
      if (some[seam.second]) all[seam.first] = true;
    }
    return all;
  };
  const std::vector<bool> next = beside(moved.moves);
  for (std::size_t i = 0; i < count; ++i) moved.moves[i] = moved.moves[i] || next[i];
  const std::vector<bool> around = beside(moved.moves);
  for (std::size_t i = 0; i < count; ++i) moved.holds[i] = around[i] && !moved.moves[i];
  return moved;
}

}  // namespace

JointPart PartFitter::joint_part(const MovedSurface& moved, const PartPlan& own, const PartPlan& met,
                                 bool held) const {
  const PartFit& fit = own.fit;
  const SweepEffort effort = final_effort(fit.family.count(), own.calm, own.steadying);
  JointPart joint;
  joint.data = sections_of(moved, effort);
  joint.options = options_for(joint.data, effort);
  joint.options.blade_length_mm = fit.blade_length_mm;
  joint.start = met.fit.family;
  joint.wanted_mm = wanted_mm();
  joint.most_mm = std::max(most_mm(own), fit.max_mm);
  joint.held = held;
  return joint;
}

void PartFitter::measure_seams(const std::vector<PartSeam>& seams, std::vector<PartPlan>& met) const {
  std::vector<SeamFacts> facts(seams.size());
  tbb::parallel_for(std::size_t{0}, seams.size(), [&](std::size_t i) {
    facts[i] = seam_facts(seams[i], met[seams[i].first].fit.family, met[seams[i].second].fit.family,
                          settings_.blade.free_lengths_mm.back());
  });
  gpu::stop_point();
  for (PartPlan& plan : met) {
    if (plan.strip) plan.strip->seam_before = {};
  }
  for (std::size_t i = 0; i < seams.size(); ++i) {
    std::optional<StripPlan>& strip = met[seams[i].second].strip;
    if (!strip) continue;
    strip->seam_before.gap_mm = std::max(strip->seam_before.gap_mm, facts[i].gap_mm);
    strip->seam_before.kink_deg = std::max(strip->seam_before.kink_deg, facts[i].kink_deg);
  }
}

std::vector<PartPlan> PartFitter::join(const std::vector<SweepPart>& parts,
                                       const std::vector<PartPlan>& plans, std::vector<PartPlan> met,
                                       const std::vector<bool>& settled) const {
  std::vector<SeamSide> sides;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const SweepFamily& family = plans[i].fit.family;
    sides.push_back({&parts[i].axes, &parts[i].seams, parts[i].surface.get(), plans[i].fit.formed_by.get(),
                     parts[i].bands.get(), family.first_mm, family.last_mm});
  }
  const std::vector<PartSeam> seams = seams_of(sides, section_options(settings_, {}, 1, 1, nullptr, nullptr));
  if (seams.empty()) return met;
  const Moved moved = moved_parts(settled, seams);
  std::vector<std::size_t> part_of, place(parts.size());  // of the joint fit, and in it
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!moved.moves[i] && !moved.holds[i]) continue;
    place[i] = part_of.size();
    part_of.push_back(i);
  }
  std::vector<JointPart> joined(part_of.size());
  std::vector<MovedPart> surfaces(part_of.size());
  tbb::parallel_for(std::size_t{0}, joined.size(), [&](std::size_t k) {
    watch_();
    const std::size_t i = part_of[k];
    const PartFit& fit = plans[i].fit;
    surfaces[k] = moved_of(parts[i], final_effort(fit.family.count(), plans[i].calm, plans[i].steadying),
                           fit.formed_by.get());
    joined[k] = joint_part(*surfaces[k], plans[i], met[i], moved.holds[i]);
  });
  gpu::stop_point();
  std::vector<PartSeam> between;
  for (const PartSeam& seam : seams) {
    if (!moved.moves[seam.first] && !moved.moves[seam.second]) continue;
    between.push_back({place[seam.first], place[seam.second], seam.places});
  }
  const std::vector<SweepFitReport> fits = fit_together(joined, between, watch_);
  tbb::parallel_for(std::size_t{0}, joined.size(), [&](std::size_t k) {
    if (joined[k].held) return;
    watch_();
    const std::size_t i = part_of[k];
    met[i] = this->met(*surfaces[k], joined[k], fits[k].family, plans[i]);
  });
  gpu::stop_point();
  measure_seams(seams, met);
  return met;
}

// Where a blade that may bend as sharply as it likes would follow the part, its radius is the reason.
void PartFitter::explain(const SweepPart& part, PartPlan& plan) const {
  const SweepEffort effort = close_effort();
  const SweepData data = sections_of(*moved_of(part, effort, nullptr), effort);
  if (data.sections.empty()) return;
  SweepFitOptions options = options_for(data, effort);
  const double limit = 1 / max_curvature_per_mm(settings_.blade);
  options.smallest_radius_mm = 0;
  options.block.reset();
  options.blade_length_mm = rib_length(plan.fit);
  const SweepFitReport free = fit_sweep(data, options, nullptr);
  if (free.max_mm <= settings_.design.tolerance_mm && free.smallest_radius_mm < limit)
    plan.refusal = Refusal{"", "", Limit::kRibRadius, free.smallest_radius_mm, limit};
}

}  // namespace hotblade::pipeline
