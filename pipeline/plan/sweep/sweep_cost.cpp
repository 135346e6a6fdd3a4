#include "pipeline/plan/sweep/sweep_cost.hpp"

#include <algorithm>
#include <cmath>

namespace hotblade::pipeline {

double cost_mm(const FollowedPart& part) {
  // A clamp in the clearance is moved by turning the blade's end: 10 mm of it cost about 1 mm at the rib.
  constexpr double kPerDepth = 0.1;
  // In tolerances: above every deviation that a closer fit may mend, below what only a split does.
  constexpr double kUnstable = 2;
  // A radius a hundredth too small counts as 1 mm: yield is not to be traded for closeness.
  constexpr double kSharpMm = 100;
  const bool stable = std::isfinite(part.sag_mm) && part.margin >= part.least_margin;
  const double sag = stable ? part.unknown_share * part.sag_mm : kUnstable * part.tolerance_mm;
  const double sharp = 1 - part.radius_mm / part.least_radius_mm;
  return part.deviation_mm + sag + kPerDepth * part.clamp_depth_mm + kSharpMm * std::max(0.0, sharp);
}

double cost_mm(const HeldBlade& blade) {
  return blade.deviation_mm + blade.clamps_mm + blade.unknown_sag_mm;
}

bool clamps_lead(const HeldBlade& blade) {
  return blade.clamps_mm > std::max(blade.deviation_mm, blade.unknown_sag_mm);
}

bool worth_steadying(const HeldBlade& steadier, const HeldBlade& blade, bool longer) {
  // A longer blade takes room in the cell, and another of the list.
  const double share = longer ? 0.9 : 0.98;
  return cost_mm(steadier) < share * cost_mm(blade);
}

double steady_deviation_mm(double before_mm, double wanted_mm, double tolerance_mm) {
  constexpr double kMoreShare = 0.2;
  return std::max(before_mm, wanted_mm) + kMoreShare * tolerance_mm;
}

double cost_mm(const UnfollowedPart& part) {
  if (part.empty) return 2 * kHopeless_mm;
  constexpr double kPerRad = 1e3;  // mm: what faces away is worse than what is too long for a block
  return kHopeless_mm + kPerRad * (part.turn_rad + part.slope_rad) + part.gap_mm + part.block_mm +
         part.rib_mm;
}

double narrowing(double cost) {
  constexpr double kPower = 0.3;
  return std::pow(cost, -kPower);
}

}  // namespace hotblade::pipeline
