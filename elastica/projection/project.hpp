// Projection of a cubic Bezier towards the elastica: lowers the lambda-residual while both end points and
// both end tangents stay, by moving the inner control points along the end tangents (Brander, Bærentzen,
// Fisker, Gravesen, "Bezier curves that are close to elastica", section 6).
#pragma once

#include <span>

#include "elastica/bezier/bezier.hpp"
#include "elastica/bezier/standard_position.hpp"

namespace hotblade::elastica {

enum class Branch { kInflectional, kPlain };

enum class ProjectStatus {
  kReached,      // lambda-residual at or below the threshold
  kNotReached,   // the best the deformation has is above the threshold
  kUnsupported,  // coincident end points or a zero end edge: returned unchanged
};

// Return the words for them.
[[nodiscard]] constexpr const char* name(Branch branch) {
  return branch == Branch::kInflectional ? "inflectional" : "plain";
}
[[nodiscard]] constexpr const char* name(ProjectStatus status) {
  constexpr const char* kNames[] = {"ok", "not_reached", "unsupported"};
  return kNames[static_cast<int>(status)];
}

struct Projection {
  Bezier bezier;
  double lambda_residual = 0;
  Branch branch = Branch::kPlain;
  std::array<double, 2> moved{0, 0};    // change of the two end edges, in chord lengths
  bool angle_constraints_hold = false;  // the paper's angle constraints 1 and 2
  ProjectStatus status = ProjectStatus::kReached;
};

// The paper's feedback projection down to `threshold` in [0, 1). Where the first and the third edge cross,
// it shortens both first, and no result has them crossing. A curve that is at the threshold then comes back
// as it is; otherwise the best of the deformation's steps is returned, never worse than the start.
[[nodiscard]] Projection project_feedback(const Bezier& bezier, double threshold);

// The report of a projection of `bezier`, standing at `input`, to the edges of `s`.
[[nodiscard]] Projection projection(const Bezier& bezier, const StandardPosition& input,
                                    const StandardPosition& s, double threshold);

// lambda-residual that the projection zone promises (project_zone.hpp).
inline constexpr double kZoneResidual = 0.4;

enum class WantedBranch { kInflectional, kPlain, kBest };

// The least lambda-residual over both end edges in [kShortestEdge, kLongestEdge] chords without crossing the
// first and third edge of the polygon, on the branch asked for. Differs from the paper: the optimum depends
// on the end directions alone and has several valleys, which a walk from the input can miss; a table made at
// build time says where they lie, and Newton's method finds their floors to a thousandth of the residual
// (docs/elastica.md). kUnsupported also when the branch has no curve in the domain; `status` is kReached
// otherwise. The input's own edges are not considered: the result is the same for every curve of the same end
// points and tangents.
[[nodiscard]] Projection project_optimal(const Bezier& bezier, WantedBranch wanted);

// The edge lengths of an optimum alone.
struct OptimalEdges {
  double l1 = 0, l2 = 0;  // chords
  double lambda_residual = 0;
  bool exists = false;  // the branch has a curve in the domain
};

// Writes the optimal projections of many curves; both spans have one size (std::logic_error).
void project_optimal(std::span<const Bezier> beziers, WantedBranch wanted, std::span<Projection> out);

// Writes the optima of many pairs of end directions (rad, in (-pi, pi]), as project_optimal takes them; all
// spans have one size (std::logic_error). Several threads may run at once; splitting a batch changes no bit.
void optimal_edges(std::span<const double> a1, std::span<const double> a2, WantedBranch wanted,
                   std::span<OptimalEdges> out);

// The smallest move of the inner control points along the end tangents, sqrt(dL1^2 + dL2^2) chords, that
// brings the lambda-residual to `threshold`, in the domain of project_optimal and on the branch asked for. A
// curve that is there already comes back as it is. kNotReached with the optimum where project_optimal ends
// above the threshold; kUnsupported as there. It takes some milliseconds a curve (docs/elastica.md).
[[nodiscard]] Projection project_smallest_move(const Bezier& bezier, WantedBranch wanted, double threshold);

// project_optimal by search alone, whatever it costs: the oracle of project_optimal. A logarithmic grid of
// options.grid edges either way (std::logic_error below 2), its options.refined best local minima refined by
// pattern search.
struct SearchOptions {
  int grid = 41;
  std::size_t refined = 12;
};
[[nodiscard]] Projection project_optimal_search(const Bezier& bezier, WantedBranch wanted,
                                                const SearchOptions& options);

// The domain of the optimal projections: end edges in chords.
inline constexpr double kShortestEdge = 0.02, kLongestEdge = 4;

}  // namespace hotblade::elastica
