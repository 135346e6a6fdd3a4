// One strip before motion: its ribs in common axes, the block they are cut from, and the blade that cuts it.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plan/ribs/rib_axes.hpp"
#include "pipeline/plan/ribs/rib_fit.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// What of its ribs a strip forms at a place of the sweep, by share of their length; the rest is waste.
struct FormedPart {
  double offset_mm = 0;
  DesignPart part;
};

// What stands between the surfaces of two strips at their seam.
struct SeamFacts {
  double gap_mm = 0, kink_deg = 0;
};

// One strip before motion: ribs in common axes, the block, and the blade that cuts it.
struct StripPlan : RibAxes {
  std::string id;
  std::vector<RibFit> ribs;
  std::vector<FormedPart> formed;  // of ribs that go on past the design's border: by sections, ascending
  double blade_length_mm = 0;
  double share_a = 0.5;  // share of the extension that lies before the rib's start, on clamp A's side
  Block block;
  Pose design_to_cell;
  double joint_fit_mm = 0;  // what fitting it together with its neighbours added to its largest deviation
  SeamFacts seam_before;    // largest, to the strips before that it meets; zeros where there is none
  double on_mm = 0;         // that planes and shapes go on by as they came past the end ribs
  double smallest_margin = 0, largest_curvature_per_mm = 0, smallest_clearance_mm = 0;
  double sag_mm = 0;  // what weight moves the cut by at the ribs, before it is compensated

  // Returns what is formed at an offset: between sections no less than what the ones around it form, and
  // never nothing.
  [[nodiscard]] DesignPart formed_at(double offset_mm) const;

  // Returns where the blade's plane is on its way through the block and out of it: planes of a fan go on
  // straight, along their normals, soon before the first and behind the last rib.
  [[nodiscard]] Frame swept_plane(double offset_mm) const;
};

// Returns how far planes and shapes have to go on as they came past the end ribs, which lie `over_mm` past
// the design's: until no width reaches over it any more, also where a fan's planes lie closer, at most
// kMostOnMm.
[[nodiscard]] double way_on_mm(const StripPlan& strip, double width_mm, double over_mm);

// Returns whether two strips are cut by the same blades from the same block, to the bit. Their names, and
// what stands between them and their neighbours, may differ.
[[nodiscard]] bool same_blades(const StripPlan& a, const StripPlan& b);

// Returns the blade of a rib: its elastica extended along itself to the strip's blade length.
[[nodiscard]] elastica::Elastica extended(const elastica::Elastica& rib, double blade_length_mm,
                                          double share_a);

}  // namespace hotblade::pipeline
