// An elastica near points that leaves from a given end point and tangent, and arrives at another where one is
// given: both ends clamped leave a one-parameter family (by length) with several branches, of which the
// nearest to the points is sought. Any length unit.
#pragma once

#include <optional>
#include <span>

#include "elastica/bezier/bezier.hpp"
#include "elastica/curve/placement.hpp"
#include "elastica/fit/fit.hpp"

namespace hotblade::elastica {

struct ClampedEnds {
  PlanarPose start;
  // The curve turns by end.theta - start.theta in all, not modulo 2 pi. Left absent, the end is free.
  std::optional<PlanarPose> end;
};

enum class ClampedStatus {
  kOk,
  kNotConverged,  // keeps the ends, but the search was still moving
  kNoCurve,  // no branch that was found reaches the end with that turning; `elastica` is the closest miss
};

// Returns the word for a status.
[[nodiscard]] constexpr const char* name(ClampedStatus status) {
  constexpr const char* kNames[] = {"ok", "not_converged", "no_curve"};
  return kNames[static_cast<int>(status)];
}

struct ClampedFit {
  Elastica elastica;      // starts at ends.start exactly
  double rms = 0;         // proportional-parameter distance to the points as they count
  double max = 0;         // largest distance from a point to the elastica
  double end_miss = 0;    // of the end point, unit of the input
  double angle_miss = 0;  // of the end's tangent, rad
  int starts_tried = 0;
  ClampedStatus status = ClampedStatus::kNoCurve;
};

// The elastica nearest to the points that keeps the ends. `points` run from start to end, evenly spaced by
// arc length, at least 8, finite and not all the same (std::logic_error); weights, where given, are one for
// each. The search starts from `starts`, or from the free fit when there are none; where that misses the
// end, or the free fit led farther off than 1e-3 of the length, it starts from the free fit and thirteen
// more.
[[nodiscard]] ClampedFit fit_clamped(std::span<const Eigen::Vector2d> points, const ClampedEnds& ends,
                                     std::span<const Elastica> starts, const FitOptions& options);

// The elastica nearest to a Bezier that keeps its end points and tangents; kNoCurve also for a cusp or an
// end edge of length zero.
[[nodiscard]] ClampedFit fit_clamped(const Bezier& bezier);

// The true turning, rad, from `start_theta` to `end_theta` along the points, for end directions that are
// known modulo 2 pi: end.theta - start.theta as ClampedEnds asks for it.
[[nodiscard]] double true_turning(std::span<const Eigen::Vector2d> points, double start_theta,
                                  double end_theta);

}  // namespace hotblade::elastica
