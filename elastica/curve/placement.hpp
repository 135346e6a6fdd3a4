// Where curves lie in the plane: places with a direction, and elastica moved as a whole. Any length unit,
// rad.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

// A place in the plane with a direction: where a curve starts or ends, and how a clamp holds it.
struct PlanarPose {
  double x = 0, y = 0, theta = 0;
};

// Returns the force (lambda1, lambda2) in axes turned by the angle of this cosine and sine.
[[nodiscard]] inline Eigen::Vector2d force_in_axes(const Elastica& e, double cos, double sin) {
  return {cos * e.lambda1 + sin * e.lambda2, cos * e.lambda2 - sin * e.lambda1};
}

// Returns the force along and across the tangent of the direction theta.
[[nodiscard]] inline Eigen::Vector2d force_along(const Elastica& e, double theta) {
  return force_in_axes(e, std::cos(theta), std::sin(theta));
}

// Returns the curve moved by a turn and a shift: point_at(transformed(e, move), s) is move * point_at(e, s).
// The force turns with the curve, its curvature stays. `move` may not mirror.
[[nodiscard]] inline Elastica transformed(const Elastica& e, const Eigen::Isometry2d& move) {
  const Eigen::Vector2d start = move * Eigen::Vector2d(e.x, e.y);
  const double cos = move(0, 0), sin = move(1, 0);
  const Eigen::Vector2d force = force_in_axes(e, cos, -sin);
  return {start.x(), start.y(), e.theta + std::atan2(sin, cos), e.kappa, force.x(), force.y(), e.length};
}

// Returns the curve moved to start at the origin along the x axis.
[[nodiscard]] inline Elastica at_origin(const Elastica& e) {
  const Eigen::Vector2d force = force_along(e, e.theta);
  return {0, 0, 0, e.kappa, force.x(), force.y(), e.length};
}

}  // namespace hotblade::elastica
