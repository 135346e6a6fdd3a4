// How far the clamps of a strip may err at each pose before the blade's shape is lost (margin_mm).
//
// The distance to the nearest loss, a fold or the straight blade, is searched for at some poses and bounded
// from below at the others: it falls by no more than the clamps move (elastica/blade/clamp_margin.hpp).
// Between two searched poses the bound is at least kMarginShare of the smaller of both, of the pose's own
// distance to the straight blade, which is exact, or of kFarFromFoldMm. Searches look farther than
// kFarFromFoldMm: what is not near for long needs few. They look no farther than the straight blade, where
// folds of both sides meet, and so bound no more than that.
#pragma once

#include <vector>

#include "pipeline/plan/motion/motion.hpp"

namespace hotblade::pipeline {

// Folds farther away are not told apart: fifty times what clamps err, a quarter of it for the coarsest.
inline constexpr double kFarFromFoldMm = 20;
inline constexpr double kMarginShare = 0.7;
// Folds are looked for this far, in shares of the blade's length: one farther away than kFarFromFoldMm is not
// told, but bounds the poses around for as long as the clamps need to come to it. Twice as far finds few
// more.
inline constexpr double kFoldSearchShare = 0.1;

// How far the clamps may err at a pose, kFarFromFoldMm standing for that much or more.
struct PoseMargin {
  double margin_mm = 0;  // no loss is nearer
  // The blade snaps to another shape: what is known where a fold may be the nearest loss, or may be too near
  // before the straight blade is; kFarFromFoldMm elsewhere.
  double fold_mm = 0;
  double straight_mm = 0;  // the blade is straight, and may bow to either side
};

// Returns the margins of all poses, the same whatever the number of threads. Where the straight blade is the
// nearest loss, poses that are farther from it than a strip may be from a fold (smallest_margin_mm) are
// searched until none is known to be nearer than that. Once a fold is found nearer, bounds are as close as
// told above to the smallest such distance only: the strip is refused.
[[nodiscard]] std::vector<PoseMargin> clamp_margins(const std::vector<BladePose>& poses,
                                                    const Settings& settings);

// Returns the smallest margin to a fold that a strip may have: blade.min_margin_mm, or twice the worst error
// of the clamps where that is 0. Once would be a shape that the errors given can lose; twice leaves as much
// again for what is not counted: the blade's stiffness, weight and heat.
[[nodiscard]] double smallest_margin_mm(const Settings& settings, double blade_length_mm);

}  // namespace hotblade::pipeline
