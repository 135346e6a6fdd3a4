// The joint fit of a strip: all ribs solved together, so that both clamps move smoothly from rib to rib while
// every rib stays near its own best fit.
#pragma once

#include <vector>

#include "pipeline/plan/ribs/rib_fit.hpp"

namespace hotblade::pipeline {

struct JointFitOptions {
  double blade_length_mm = 0, share_a = 0.5;  // of the strip's blade, as StripPlan
  double feed_mm_s = 7;                       // speed along the sweep that accelerations are told for
  // A rib's deviation may grow by this, and to no more than `most_mm`.
  double allowance_mm = 0, most_mm = 0;
};

struct JointFitReport {
  // Largest acceleration of a clamp at a rib, from its second difference over the neighbouring ribs.
  double acceleration_before_mm_s2 = 0, acceleration_after_mm_s2 = 0;
  double weight = 0;  // of the clamps' second differences; 0: the ribs are as they were
};

// Least squares over the mid states of all ribs (seven numbers each): distances of the target's points from
// the elastica, and the second differences of both clamp poses along the sweep. Only neighbours meet in a
// residual, so the normal equations are banded and the cost grows linearly with the ribs. The heaviest weight
// of a fixed list under which every rib keeps its allowance is taken; ends shared with a neighbouring strip
// stay. Fewer than three ribs are left as they are, and so are ribs whose blade would wind up
// (kMostTurnsRad). The result does not depend on threads.
[[nodiscard]] JointFitReport joint_fit(std::vector<RibFit>& ribs, const JointFitOptions& options);

// Largest clamp acceleration of the ribs as they are, mm/s2.
[[nodiscard]] double clamp_acceleration_mm_s2(const std::vector<RibFit>& ribs,
                                              const JointFitOptions& options);

}  // namespace hotblade::pipeline
