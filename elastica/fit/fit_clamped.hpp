// An elastica near points that leaves from a given end point and tangent, and arrives at another where one is
// given: both ends clamped leave a one-parameter family (by length) with several branches, of which the
// nearest to the points is sought. Any length unit.
#pragma once

#include <optional>
#include <span>

#include "elastica/bezier/bezier.hpp"
#include "elastica/curve/elastica.hpp"
#include "elastica/fit/fit.hpp"

namespace hotblade::elastica {

struct EndState {
  double x = 0, y = 0, theta = 0;
};

struct ClampedEnds {
  EndState start;
  // The true turning is end.theta - start.theta, not modulo 2 pi. Absent: the end is free.
  std::optional<EndState> end;
};

enum class ClampedStatus {
  kOk,
  kNotConverged,  // keeps the ends, but the search was still moving
  kNoCurve,  // no branch that was found reaches the end with that turning; `elastica` is the closest miss
};

struct ClampedFit {
  Elastica elastica;      // starts at ends.start exactly
  double rms = 0;         // proportional-parameter distance to the points as they count
  double max = 0;         // largest distance from a point to the elastica
  double end_miss = 0;    // of the end point, unit of the input
  double angle_miss = 0;  // of the end's tangent, rad
  int starts_tried = 0;
  ClampedStatus status = ClampedStatus::kNoCurve;
};

// `points` run from start to end, evenly spaced by arc length, at least 8, finite, not all the same
// (std::logic_error); weights one for each of them. Searched from `starts`; without any from the free fit.
// Where that misses the end, or the free fit led farther off than 1e-3 of the length, from the free fit and
// thirteen more.
[[nodiscard]] ClampedFit fit_clamped(std::span<const Eigen::Vector2d> points, const ClampedEnds& ends,
                                     std::span<const Elastica> starts, const FitOptions& options);

// Both end points and tangents of the Bezier kept. kNoCurve also for a cusp or an end edge of length zero.
[[nodiscard]] ClampedFit fit_clamped(const Bezier& bezier);

// Direction of travel along the points from start to end with its true turning, given the directions at both
// ends modulo 2 pi: what ClampedEnds asks for.
[[nodiscard]] double true_turning(std::span<const Eigen::Vector2d> points, double start_theta,
                                  double end_theta);

}  // namespace hotblade::elastica
