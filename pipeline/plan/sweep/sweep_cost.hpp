// What a part costs on the way to a plan: every weight by which one layout of parts is preferred to another.
//
// A layout costs what its worst part does, in mm; of two that cost as much the one named first is taken. Any
// fit costs less than any part without one.
#pragma once

namespace hotblade::pipeline {

// A part that a family was fitted to.
struct FollowedPart {
  double deviation_mm = 0;     // largest of the fit, at its samples
  double sag_mm = 0;           // by which weight moves the cut; not finite: the blade tips
  double unknown_share = 1;    // of the sag, which no compensation takes away
  double margin = 0;           // of the blade's stability
  double least_margin = 0;     // that is accepted
  double clamp_depth_mm = 0;   // of a clamp in the block's clearance
  double radius_mm = 0;        // least of the blade
  double least_radius_mm = 0;  // within yield
  double tolerance_mm = 1;
};
// Returns the deviation with what of the sag is not known and what the blade's limits are missed by.
[[nodiscard]] double cost_mm(const FollowedPart& part);

// What of the error budget a strip's blade decides: its length, its share of it before the part, its tension.
struct HeldBlade {
  double deviation_mm = 0;    // largest of the fit
  double clamps_mm = 0;       // what the clamps' errors move the cut by, at most
  double unknown_sag_mm = 0;  // what of its weight is not known, or not compensated
};
// Returns the sum.
[[nodiscard]] double cost_mm(const HeldBlade& blade);
// Whether the clamps' errors are the largest of the three: then a steadier blade is looked for.
[[nodiscard]] bool clamps_lead(const HeldBlade& blade);
// Whether a blade that is as long, or a longer one, costs so much less that it is worth the fit.
[[nodiscard]] bool worth_steadying(const HeldBlade& steadier, const HeldBlade& blade, bool longer);
// Returns what a steadier blade may deviate by: a fifth of the tolerance more than the one before, or than
// what is wanted of a fit.
[[nodiscard]] double steady_deviation_mm(double before_mm, double wanted_mm, double tolerance_mm);

// A part that no family is fitted to: by how much it is too large, too steep or too curved for one; 0: not.
struct UnfollowedPart {
  bool empty = false;  // no plane meets it
  double turn_rad = 0, slope_rad = 0;
  double gap_mm = 0, block_mm = 0, rib_mm = 0;
};
// Returns above kHopeless_mm.
[[nodiscard]] double cost_mm(const UnfollowedPart& part);

// No fit costs as much.
inline constexpr double kHopeless_mm = 1e6;

// Returns by how much narrower a part is to be made than one that costs 1 mm, so that both cost the same: a
// family's deviation grows with about the cube of its width.
[[nodiscard]] double narrowing(double cost);

}  // namespace hotblade::pipeline
