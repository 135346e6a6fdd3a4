// Projection of a cubic Bezier towards the elastica: lowers the lambda-residual while both end points and
// both end tangents stay, by moving the inner control points along the end tangents (Brander, Bærentzen,
// Fisker, Gravesen, "Bezier curves that are close to elastica", section 6).
#pragma once

#include "elastica/bezier.hpp"
#include "elastica/standard_position.hpp"

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

// The report of a projection of `bezier`, standing at `input`, to the edges of `s`.
[[nodiscard]] Projection projection(const Bezier& bezier, const StandardPosition& input,
                                    const StandardPosition& s, double threshold);

// lambda-residual that the projection zone promises (project_zone.hpp).
inline constexpr double kZoneResidual = 0.4;

enum class WantedBranch { kInflectional, kPlain, kBest };

// The least lambda-residual over both end edges in [kShortestEdge, kLongestEdge] chords without crossing the
// first and third edge of the polygon, on the branch asked for: a logarithmic grid of both edges, its best
// cells refined by pattern search. Differs from the paper: the optimum depends on the end directions alone
// and has one valley on either branch, which a walk from the input can miss. kUnsupported also when the
// branch has no curve in the domain; `status` is kReached otherwise. The input's own edges are not
// considered: the result is the same for every curve of the same end points and tangents.
[[nodiscard]] Projection project_optimal(const Bezier& bezier, WantedBranch wanted);

// The same by search alone, whatever it costs: the oracle of project_optimal. A logarithmic grid of
// options.grid edges either way (std::logic_error below 2), its options.refined best local minima refined by
// pattern search.
struct SearchOptions {
  int grid = 41;
  std::size_t refined = 12;
};
[[nodiscard]] Projection project_optimal_search(const Bezier& bezier, WantedBranch wanted,
                                                const SearchOptions& options);

inline constexpr double kShortestEdge = 0.02, kLongestEdge = 4;

}  // namespace hotblade::elastica
