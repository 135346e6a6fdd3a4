// How a part is planned: closer fits, calmer ones, steadier ones.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/plan/motion/blade.hpp"
#include "pipeline/plan/motion/clamp_margins.hpp"
#include "pipeline/plan/motion/rib_clamp_error.hpp"
#include "pipeline/plan/motion/rib_fold.hpp"
#include "pipeline/plan/sweep/sweep_facets.hpp"
#include "pipeline/plan/sweep/sweep_part.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Whether more coefficients bring a fit as near as it has to be: from `before_mm` to `now_mm` those so far
// did. Every step gains less than the one before as a rule; of 809 parts planned none gained three times as
// much.
bool comes_near(double before_mm, double now_mm, int steps_left, double wanted_mm) {
  constexpr double kMore = 3;
  const double gain_mm = std::max(0.0, before_mm - now_mm);
  return now_mm - kMore * steps_left * gain_mm <= wanted_mm;
}

}  // namespace

// Closer and closer fits of one pull towards few and smooth tensions, as long as these help.
PartPlan PartFitter::plan_at(const SweepPart& part, const PartFit& start, double calm) const {
  constexpr double kHelps = 0.8;  // of the deviation before
  constexpr std::array kCoefficients{5, 7, 10, 14};
  // Tolerances that the first fit may be off by: of 809 parts planned none with a strip was off by four.
  constexpr double kFirst = 6;
  const double near_mm = near_enough_mm(part), tolerance_mm = settings_.design.tolerance_mm;
  PartPlan best{start, std::nullopt, start.refusal, calm};
  best.fit.max_mm = kInfinite;
  PartFit now = start;
  double last_mm = kInfinite;  // of the fit before
  for (std::size_t i = 0; i < kCoefficients.size(); ++i) {
    const SweepEffort effort = final_effort(kCoefficients[i], calm);
    MovedPart moved;
    now = fit(part, effort, &now, moved);
    if (!now.holds()) {
      if (!best.strip) best.refusal = now.refusal;
      break;
    }
    const double before = best.fit.max_mm, was_mm = std::exchange(last_mm, now.max_mm);
    // One that does not help need not be the last: a triangle takes 7 strips by it, and 9 without.
    if (best.strip && !(now.max_mm < kHelps * before)) continue;
    PartFit fitted = now;
    SweptStrip made = strip_of(part, effort, fitted, std::move(moved));
    double wanted_mm = tolerance_mm;
    if (!made.strip && made.refusal.limit == Limit::kSag)
      wanted_mm -= (tolerance_mm - fitted.max_mm) * made.refusal.value / made.refusal.bound;
    if (made.strip && (!best.strip || fitted.max_mm < kHelps * before)) {
      best = {std::move(fitted), std::move(made.strip), std::nullopt, calm};
    } else if (!made.strip && !best.strip && !(fitted.max_mm > before)) {
      best = {std::move(fitted), std::nullopt, made.refusal, calm};
    }
    if (best.strip && best.fit.max_mm <= near_mm) break;
    const auto left = static_cast<int>(kCoefficients.size() - 1 - i);
    if (!best.strip &&
        !(i == 0 ? now.max_mm <= kFirst * tolerance_mm : comes_near(was_mm, now.max_mm, left, wanted_mm)))
      break;
  }
  return best;
}

namespace {

// A calmer blade comes no nearer, hangs as far and takes as large a block.
bool calmer_may_hold(const Refusal& refusal) {
  return is_of_the_shape(refusal.limit) && !stable_as_can_be(refusal.limit, refusal.value);
}

}  // namespace

// A blade that its clamps' errors would snap bends more than it needs to: what the fit leaves of the
// tolerance is given for tensions that are calmer, up to the first that hold.
PartPlan PartFitter::plan(const SweepPart& part, const PartFit& start, double calmer_than) const {
  PartPlan best{start, std::nullopt, start.refusal, 0};
  if (!start.holds()) return best;
  for (const double calm : kCalms) {
    if (calm <= calmer_than) continue;
    PartPlan plan = plan_at(part, start, calm);
    // A calmer blade comes no nearer.
    const bool too_far = plan.strip ? best.strip && !(plan.fit.max_mm <= most_mm(plan))
                                    : plan.refusal && plan.refusal->limit == Limit::kDeviation;
    if (plan.strip) {
      plan.fold_mm = fold_of(plan);
      if (!too_far && (!best.strip || plan.fold_mm > best.fold_mm)) best = std::move(plan);
      if (best.fold_mm >= least_fold_mm(best)) break;
    } else if (!best.strip) {
      best = std::move(plan);
    }
    if (too_far || (best.refusal && !calmer_may_hold(*best.refusal))) break;
  }
  if (best.refusal && best.refusal->limit == Limit::kDeviation) explain(part, best);
  return best;
}

// Of what one rib may deviate: edges, corners and what lies between samples have the rest.
double PartFitter::wanted_mm() const {
  constexpr double kWanted = 0.5;
  return kWanted * settings_.fit.deviation_share * settings_.design.tolerance_mm;
}

// More coefficients bring no blade much nearer to facets than what these leave for a smooth cut, but where it
// bends at their edges.
double PartFitter::near_enough_mm(const SweepPart& part) const {
  // The facets' own figure is of half of their area. A reserve stays for what lies between samples.
  constexpr double kOver = 1.25, kMostShare = 0.6;
  const double facets_mm = kOver * smooth_over_facets(*part.surface, part.seams).off_mm;
  return std::max(wanted_mm(), std::min(facets_mm, kMostShare * settings_.design.tolerance_mm));
}

double PartFitter::most_mm(const PartPlan& plan) const {
  // Edges and corners between the samples are farther off than these, on most panels by less than a tenth of
  // the tolerance. What was found of a strip is hardly more of the next fit.
  constexpr double kBetween = 0.1, kMore = 0.03;
  const double tolerance = settings_.design.tolerance_mm;
  if (plan.beyond_fit_mm) return (1 - kMore) * tolerance - *plan.beyond_fit_mm;
  return (1 - kBetween) * tolerance - robot::kSagUnknownShare * plan.fit.sag_mm;
}

double PartFitter::fold_of(const PartPlan& plan) const {
  constexpr double kFar = 3;  // times what is wanted: of two that are farther neither is the better
  return rib_fold_mm(*plan.strip, settings_.machine, kFar * least_fold_mm(plan));
}

double PartFitter::least_fold_mm(const PartPlan& plan) const {
  // Between ribs and on its way into the block a blade snaps a little sooner than at its ribs.
  constexpr double kReserve = 1.2;
  return kReserve * smallest_margin_mm(settings_, plan.strip->blade_length_mm);
}

HeldBlade PartFitter::held(const PartPlan& plan) const {
  // In a fan nothing of it is compensated.
  const double left = robot::kSagUnknownShare + (plan.strip->planes.turns() ? 1 : 0);
  return {plan.fit.max_mm, rib_clamp_error_mm(*plan.strip, settings_.machine), left * plan.strip->sag_mm};
}

// The strip fitted on with blades of this length and this pull, where it stays as near as it is to be.
std::optional<PartPlan> PartFitter::steadier(const SweepPart& part, const PartPlan& plan, const PartFit& from,
                                             const Steadying& steadying) const {
  const double most_mm = steady_deviation_mm(plan.fit.max_mm, wanted_mm(), settings_.design.tolerance_mm);
  PartPlan other = plan;
  other.steadying = steadying;
  const SweepEffort effort = final_effort(plan.fit.family.count(), plan.calm, steadying);
  MovedPart moved;
  other.fit = fit(part, effort, &from, moved);
  if (!other.fit.holds() || !(other.fit.max_mm <= most_mm)) return std::nullopt;
  SweptStrip made = strip_of(part, effort, other.fit, std::move(moved));
  if (!made.strip || !(other.fit.max_mm <= most_mm)) return std::nullopt;
  other.strip = std::move(made.strip);
  other.fold_mm = fold_of(other);
  if (!(other.fold_mm >= std::min(plan.fold_mm, least_fold_mm(other)))) return std::nullopt;
  other.held = held(other);
  return other;
}

PartPlan PartFitter::steadied(const SweepPart& part, PartPlan plan) const {
  plan.held = held(plan);
  // Where the budget only warns, the shortest blade and the nearest fit are kept.
  if (settings_.design.over_budget != OverBudget::kRefuse || !clamps_lead(*plan.held)) return plan;
  // With a fifth, a blade that moves by 1 mm counts as much as one that is off by 0.2 mm everywhere.
  constexpr std::array<double, 3> kPulls{0.2, 0.1, 0.05};
  const double own_mm = plan.strip->blade_length_mm;
  PartPlan best = plan;
  for (const double length_mm : settings_.blade.free_lengths_mm) {
    if (length_mm < own_mm) continue;
    const auto take = [&](std::optional<PartPlan> other) {
      if (!other || !(cost_mm(*other->held) < cost_mm(*best.held))) return false;
      best = std::move(*other);
      return true;
    };
    bool helps = false;
    // A longer blade alone, and one that is pulled to be steady as strongly as its fit lets it.
    if (length_mm > own_mm) helps = take(steadier(part, plan, plan.fit, {0, length_mm}));
    for (const double pull : kPulls) {
      std::optional<PartPlan> other = steadier(part, plan, best.fit, {pull, length_mm});
      const bool near = other.has_value();
      helps = take(std::move(other)) || helps;
      if (near) break;
    }
  }
  const bool longer = best.strip->blade_length_mm > own_mm;
  if (!worth_steadying(*best.held, *plan.held, longer)) return plan;
  best.unsteady = std::make_shared<const PartPlan>(std::move(plan));
  return best;
}

PartPlan PartFitter::again(const SweepPart& part, const PartPlan& plan) const {
  const SweepEffort effort = final_effort(plan.fit.family.count(), plan.calm, plan.steadying);
  PartPlan now = plan;
  MovedPart moved;
  now.fit = fit(part, effort, &plan.fit, moved);
  now.strip.reset();
  now.refusal.reset();
  if (!now.fit.holds()) {
    now.refusal = now.fit.refusal;
    return now;
  }
  SweptStrip made = strip_of(part, effort, now.fit, std::move(moved));
  now.strip = std::move(made.strip);
  if (now.strip) {
    now.fold_mm = fold_of(now);
  } else {
    now.refusal = made.refusal;
  }
  return now;
}

}  // namespace hotblade::pipeline
