// Projection of a cubic Bezier towards the elastica: lowers the lambda-residual while both end points and
// both end tangents stay, by moving the inner control points along the end tangents (Brander, Bærentzen,
// Fisker, Gravesen, "Bezier curves that are close to elastica", section 6).
#pragma once

#include "elastica/bezier.hpp"

namespace hotblade::elastica {

enum class Branch { kInflectional, kPlain };

enum class ProjectStatus {
  kReached,      // lambda-residual at or below the threshold
  kNotReached,   // the best the deformation has is above the threshold
  kUnsupported,  // coincident end points or a zero end edge: returned unchanged
};

struct Projection {
  Bezier bezier;
  double lambda_residual = 0;
  Branch branch = Branch::kPlain;
  std::array<double, 2> moved{0, 0};    // change of the two end edges, in chord lengths
  bool angle_constraints_hold = false;  // the paper's angle constraints 1 and 2
  ProjectStatus status = ProjectStatus::kReached;
};

// The paper's feedback projection down to `threshold` in [0, 1). A curve that is already there comes back
// unchanged; otherwise the best of the deformation's steps is returned, never worse than the input.
[[nodiscard]] Projection project_feedback(const Bezier& bezier, double threshold);

}  // namespace hotblade::elastica
