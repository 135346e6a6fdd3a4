// A true elastica near a curve given by points. To a Bezier: fit_bezier.hpp; with its end points and tangents
// kept: fit_clamped.hpp.
#pragma once

#include <span>
#include <vector>

#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

// The state of an elastica at its middle, in its own tangent frame there. Fits and interpolation work on it:
// it is far better conditioned than the start state, whose errors grow along the whole curve.
struct MidState {
  double x = 0, y = 0, theta = 0, kappa = 0;  // at arc length length/2
  double tension1 = 0,
         tension2 = 0;  // (lambda1, lambda2) turned by -theta: along and across the tangent, 1/unit^2
  double length = 0;
};

[[nodiscard]] MidState mid_state(const Elastica& elastica);
[[nodiscard]] Elastica from_mid_state(const MidState& mid);
// The later half: the curve from its middle to its end.
[[nodiscard]] Elastica half_from_middle(const MidState& mid);

struct FitOptions {
  // Pull of the tensions (times length^2: pure numbers) towards zero, where the curve is a circular arc; in
  // shares of the length per unit. 1e-6 moves a fit by less than 1e-5 of the length and decides only what the
  // points leave open; larger weights trade closeness for a curve that goes on calmly beyond its ends; 0:
  // none.
  double tension_weight = 1e-6;
  // Pull of curvature and tensions (times length and length^2) towards those of `prior`; nullptr: none.
  const MidState* prior = nullptr;
  double prior_weight = 0;
  // What each point counts, not negative, sum 1; empty: all the same.
  std::span<const double> weights = {};
};

struct ElasticaFit {
  Elastica elastica;
  double rms = 0;  // proportional-parameter distance to the points as they count, unit of the input
  double max = 0;  // largest distance from a point to the elastica, foot points refined
  int starts_tried = 0;
  bool converged = false;
};

// Least squares over all seven parameters, points at proportional arc length, from each start and from two of
// its own (affine curvature of the points, mean circular arc); where the best is farther off than 1e-3 of the
// length, from twelve more. `points` must be evenly spaced by arc length; at least 8, finite and not all the
// same; weights one for each of them (std::logic_error).
[[nodiscard]] ElasticaFit fit_elastica(std::span<const Eigen::Vector2d> points,
                                       std::span<const Elastica> starts, const FitOptions& options);

// Largest distance from the points to the elastica; each foot point by search over samples and Newton steps.
[[nodiscard]] double max_distance(std::span<const Eigen::Vector2d> points, const Elastica& elastica);

}  // namespace hotblade::elastica
