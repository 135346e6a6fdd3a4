// Strips that meet at seams, fitted together: each a swept family near its own samples, and at every seam
// both near each other.
//
// The terms are those of the single fit (sweep_terms.hpp), with the samples' distances to the power
// `exponent` so that the largest are held; a seam adds the square of what stands between both surfaces, on it
// and on either side, so that they meet without step and kink. What a sample is farther off than its part may
// deviate counts as well: no seam is closed by a part that fails. One sparse least-squares problem for all
// strips (Ceres).
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "pipeline/plan/sweep/sweep_fit.hpp"
#include "pipeline/plan/sweep/sweep_seams.hpp"

namespace hotblade::pipeline {

struct JointPart {
  SweepData data;
  SweepFitOptions options;
  SweepFamily start;                                         // its own fit, or the last together
  double wanted_mm = 0.1;                                    // distances below this are as good as none
  double most_mm = std::numeric_limits<double>::infinity();  // a sample beyond this makes the part fail
  bool held = false;                                         // it stays as it is, and the others meet it
};

// Returns the fits of all parts, in their order; that of a part that is held is empty. The same input gives
// the same bytes, whatever the number of threads. Parts that no seam names are fitted as they are. Throws
// std::logic_error where a part has no sections. `watch` is called now and then by this thread, about as
// often as fits of as much work would; what it throws ends the fit.
[[nodiscard]] std::vector<SweepFitReport> fit_together(const std::vector<JointPart>& parts,
                                                       const std::vector<PartSeam>& seams,
                                                       const std::function<void()>& watch = {});

}  // namespace hotblade::pipeline
