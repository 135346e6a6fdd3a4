// A true elastica near a curve given by points. fit_bezier.hpp fits one to a Bezier, fit_clamped.hpp one
// that keeps end points and tangents.
#pragma once

#include <span>
#include <vector>

#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

// The state of an elastica at its middle, in its own tangent frame there. Fits and interpolation work on it:
// it is far better conditioned than the start state, whose errors grow along the whole curve.
struct MidState {
  double x = 0, y = 0, theta = 0, kappa = 0;  // at arc length length/2
  // (lambda1, lambda2) turned by -theta: the forces along and across the tangent, 1/unit^2.
  double tension1 = 0, tension2 = 0;
  double length = 0;
};

// The state at the middle of a curve, and the curve of such a state.
[[nodiscard]] MidState mid_state(const Elastica& elastica);
[[nodiscard]] Elastica from_mid_state(const MidState& mid);
// The later half: the curve from its middle to its end.
[[nodiscard]] Elastica half_from_middle(const MidState& mid);

struct FitOptions {
  // The pull of the tensions (times length^2, so that they are pure numbers) towards zero, where the curve
  // is a circular arc; in shares of the length per unit. 1e-6 moves a fit by less than 1e-5 of the length
  // and decides only what the points leave open; larger weights trade closeness for a curve that goes on
  // calmly beyond its ends; 0 pulls nothing.
  double tension_weight = 1e-6;
  // The pull of curvature and tensions (times length and length^2) towards those of `prior`; nullptr pulls
  // nothing.
  const MidState* prior = nullptr;
  double prior_weight = 0;
  // What each point counts; none is negative and their sum is 1. Left empty, all points count the same.
  std::span<const double> weights = {};
};

struct ElasticaFit {
  Elastica elastica;
  double rms = 0;  // proportional-parameter distance to the points as they count, unit of the input
  double max = 0;  // largest distance from a point to the elastica, foot points refined
  int starts_tried = 0;
  bool converged = false;
};

// The elastica nearest to the points by least squares over all seven parameters, points at proportional arc
// length. The search starts from each of `starts` and from two of its own (affine curvature of the points,
// mean circular arc); where the best is farther off than 1e-3 of the length, from twelve more. `points` must
// be evenly spaced by arc length, at least 8, finite and not all the same; weights, where given, are one for
// each (std::logic_error).
[[nodiscard]] ElasticaFit fit_elastica(std::span<const Eigen::Vector2d> points,
                                       std::span<const Elastica> starts, const FitOptions& options);

// The largest distance from the points to the elastica; each foot point is found by search over samples and
// Newton steps.
[[nodiscard]] double max_distance(std::span<const Eigen::Vector2d> points, const Elastica& elastica);

}  // namespace hotblade::elastica
