// Which blade cuts a strip: the shortest free length whose extension clears the stock, bends within yield, is
// stable and neither crosses itself nor re-enters the part. Of the ways to share the extension between both
// sides, the one that loads blade and clamps least: the force is the same for all, so the largest moment in
// the blade decides, then the larger of the two clamps' moments, then the more even share.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "elastica/blade/blade_batch.hpp"
#include "pipeline/plan/ribs/strip_plan.hpp"
#include "pipeline/verify/refusal.hpp"

namespace hotblade::pipeline {

// The blade chosen for a strip, and what it comes to at the ribs.
struct BladeChoice {
  double length_mm = 0, share_a = 0.5;
  double smallest_margin = 0, largest_curvature_per_mm = 0, smallest_clearance_mm = 0;
  double clamp_curvature_per_mm =
      0;              // the larger of both clamps and all ribs: the moment there over the stiffness
  double sag_mm = 0;  // what weight moves the cut by at the ribs, at most
};

// The choice, or why there is none.
struct BladeReport {
  std::optional<BladeChoice> choice;
  // The limit that stopped the candidate that came furthest, when there is no choice; its details say which
  // limit stopped the best share of each length. Rib index in `rib`, or -1.
  Refusal refusal;
  int rib = -1;
  bool rib_too_sharp =
      false;  // the rib itself, without extension, bends beyond the limit: no split helps much
};

// Whether a blade was stopped by its stability, and is as stable as a straight one without load all the same
// (docs/elastica.md): neither its extension nor a calmer fit makes it much more so.
[[nodiscard]] bool stable_as_can_be(Limit limit, double value);

// What the free parts of a blade do beside its foam interval [s0, s1]; the block as the blade's plane sees
// it.
struct FreeParts {
  bool crosses_itself = false;
  // Largest depth of a free part, inside the stock, on the kept side of the part that cuts; 0 when there is
  // none.
  double depth_mm = 0;
};
// Returns what a blade's free parts do.
[[nodiscard]] FreeParts examine_free_parts(const elastica::Elastica& blade, double s0, double s1,
                                           const Block& block);
// Tells that a blade turns too little in all to meet itself, or the part that cuts: nothing is to be
// examined.
[[nodiscard]] bool makes_no_loop(const elastica::Elastica& blade);
// Returns the same of some blades by kBladeSamples points of all their length, `whole`, or fewer where none
// makes a loop; `intervals` and `blocks` are one a blade (std::logic_error).
inline constexpr std::size_t kBladeSamples = 97;
[[nodiscard]] std::vector<FreeParts> examine_free_parts(std::span<const elastica::Elastica> blades,
                                                        const elastica::PartPoints& whole,
                                                        std::span<const elastica::Part> intervals,
                                                        std::span<const Block> blocks);
// Deeper is a cut into the part; less is the sampling of the blade's curve.
inline constexpr double kFreePartDepthMm = 0.1;

// Returns the blade for a strip's ribs. It hangs as in a block that lies with its middle plane level, sweep
// downwards. Its weight may move the cut by `sag_mm`; a quarter of the tolerance where nothing is said. No
// blade shorter than `least_mm` is looked at.
[[nodiscard]] BladeReport choose_blade(const std::vector<RibFit>& ribs, const RibAxes& axes,
                                       const Block& block, const Settings& settings,
                                       std::optional<double> sag_mm = {}, double least_mm = 0);

}  // namespace hotblade::pipeline
