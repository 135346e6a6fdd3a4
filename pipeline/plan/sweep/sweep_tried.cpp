#include "pipeline/plan/sweep/sweep_tried.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "pipeline/sayings/saying.hpp"

namespace hotblade::pipeline {

using Eigen::Vector3d;

Tried first_try(Layout layout, SweepWay way) {
  Tried tried;
  tried.layout = std::move(layout);
  tried.way = way;
  return tried;
}

Tried hanging_too_far(const std::vector<Layout>& layouts, double most_mm, double tolerance_mm) {
  for (const Layout& layout : layouts) {
    if (layout.parts.size() > 1 || layout.cost_mm > most_mm) continue;
    const PartFit& fit = layout.fits.front();
    if (!layout.planes.turns() || layout.cost_mm - fit.sag_mm > tolerance_mm) continue;
    Tried tried = first_try(layout, SweepWay::kEven);
    tried.forget();
    tried.failed[0] = true;
    return tried;
  }
  return {};
}

void note_met(Tried& tried, const SweptPlan& plan, const SweepVerdict& verdict) {
  const std::size_t count = tried.layout.parts.size();
  tried.forget();
  if (verdict.taken) return;
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<Refusal>& refusal = tried.joined[i].refusal;
    const bool refused = !plan.refusals.empty();
    tried.failed[i] = refused ? !tried.joined[i].strip : verdict.failed.empty() || verdict.failed[i];
    tried.too_far[i] = refused ? refusal && refusal->limit == Limit::kDeviation
                               : !verdict.too_far.empty() && verdict.too_far[i];
    tried.misshapen[i] = refused ? refusal && is_of_the_shape(refusal->limit)
                                 : !verdict.misshapen.empty() && verdict.misshapen[i];
    if (!refused && !verdict.deviation_mm.empty())
      tried.plans[i].beyond_fit_mm = verdict.deviation_mm[i] - tried.joined[i].fit.max_mm;
  }
}

bool all_made(const std::vector<PartPlan>& plans) {
  return std::all_of(plans.begin(), plans.end(), [](const PartPlan& plan) { return plan.strip.has_value(); });
}

bool smaller(const Tried& a, const Tried& b) {
  return std::pair(a.layout.parts.size(), a.layout.cost_mm) <
         std::pair(b.layout.parts.size(), b.layout.cost_mm);
}

bool better(const Tried& a, const Tried& b) {
  if (b.layout.parts.empty()) return true;
  return std::pair(a.layout.parts.size() + a.failing(), a.layout.cost_mm) <
         std::pair(b.layout.parts.size() + b.failing(), b.layout.cost_mm);
}

SweptPlan plan_of(const Tried& tried, const std::vector<PartPlan>& plans,
                  const std::function<bool(std::size_t)>& asked) {
  SweptPlan plan;
  plan.way = tried.way;
  plan.planes = tried.layout.planes;
  plan.parts = plans.size();
  for (std::size_t i = 0; i < plans.size(); ++i) {
    if (!asked(i)) continue;
    const PartPlan& part = plans[i];
    const std::string id = fmt::format("S{:03}", i + 1);
    if (std::isfinite(part.fit.max_mm)) plan.deviation_mm = std::max(plan.deviation_mm, part.fit.max_mm);
    plan.sag_mm = std::max(plan.sag_mm, part.fit.sag_mm);
    SweptFit fit{part.fit.family.count(), part.calm, part.fit.blade_length_mm, part.fit.max_mm, 0, {}};
    if (part.held) fit.clamps_mm = part.held->clamps_mm;
    if (part.unsteady) {
      const PartPlan& before = *part.unsteady;
      fit.before = {before.strip->blade_length_mm, before.fit.max_mm, before.held->clamps_mm};
    }
    plan.fits.push_back(fit);
    if (part.strip) {
      plan.strips.push_back(*part.strip);
      plan.strips.back().id = id;
      continue;
    }
    plan.refusals.push_back(part.refusal.value_or(Refusal{"", "", Limit::kStrips, 0, 1}));
    Refusal& refusal = plan.refusals.back();
    if (refusal.strip.empty()) refusal.strip = id;
    if (!part.fit.extent.isEmpty()) set_place(tried.layout.parts[i], part.fit, refusal);
  }
  return plan;
}

void set_place(const SweepPart& part, const PartFit& fit, Refusal& refusal) {
  const bool farthest = refusal.limit == Limit::kDeviation || refusal.limit == Limit::kRibRadius;
  const Eigen::Vector2d middle = fit.extent.center();
  const Vector3d p = farthest ? part.axes.plane(fit.max_offset_mm).point(fit.max_q.x(), fit.max_q.y())
                              : part.axes.plane(middle.x()).point(middle.y(), fit.height_mm);
  refusal.place = say(farthest ? Saying::kAt : Saying::kAbout, {p.x(), p.y(), p.z()});
  refusal.at = p;
}

}  // namespace hotblade::pipeline
