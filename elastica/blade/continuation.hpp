// The shape a clamped blade takes: Newton's method from a neighbouring shape, and the branch of equilibria
// followed along a move of the clamps, with folds (snap-through) found between poses.
//
// A blade of given length between given clamps has many equilibria; the one it takes is the one reached from
// the shape before (docs/elastica.md, Continuation). Units: any length unit, rad.
#pragma once

#include <optional>

#include "elastica/blade/end_map.hpp"
#include "elastica/curve/placement.hpp"

namespace hotblade::elastica {

// Both clamps in the blade's plane; tangents point from a to b, and b.theta - a.theta is the blade's true
// turning, not modulo 2 pi. In space the pair is robot::ClampPoses.
struct ClampPair {
  PlanarPose a, b;
};

// The poses that hold the curve: its ends.
[[nodiscard]] ClampPair clamps_of(const Elastica& elastica);

// An equilibrium, and whether it is a strict minimum of the energy.
struct ClampedShape {
  Elastica elastica;
  int index = 0;  // negative eigenvalues of the second variation; 0 is stable
  int newton_steps = 0;
  // Of the same blade 1 long, at the origin along x. Fields and index are those before a last step whose
  // outcome was not looked at: a change of the unknowns by less than 6e-7, in searches 6e-6.
  JacobiFields end;
  // Of the last step of the way to it, of that blade: what the end (x, y, theta) went by, and what the
  // unknowns (kappa, lambda1, lambda2) bent from the tangent. Zero: not known.
  Eigen::Vector3d went = Eigen::Vector3d::Zero(), bent = Eigen::Vector3d::Zero();
  [[nodiscard]] bool stable() const { return index == 0; }
};

// The largest distance of the end point from its clamp over the length, and of its tangent in rad, that a
// solution has; it is a hundred times less unless the blade is taut.
inline constexpr double kClampTolerance = 1e-9;

// The largest tension times length^2 (-lambda along the chord) of a shape that is looked for. Along a blade
// pulled taut errors of the start state grow by exp(sqrt(tension)), here by 6e4, and the basin of Newton's
// method shrinks with the square of that.
inline constexpr double kLargestTension = 120;

// The equilibrium of `near`'s length between `clamps` that Newton's method reaches from the shape `near`;
// absent when it does not converge. It is quick, and right for small moves; after a large one it may land on
// another branch, which follow() does not.
[[nodiscard]] std::optional<ClampedShape> solve_clamped(const Elastica& near, const ClampPair& clamps);

enum class FollowStatus {
  kFollowed,    // the shape at the clamps' new poses
  kSnapped,     // the branch ends or loses stability on the way: the blade snaps to another shape
  kOutOfReach,  // the clamps pull the blade taut: beyond, no equilibrium or none that a start state can carry
};

struct FollowOptions {
  // The step of the way at which a branch that cannot be followed counts as lost; places of snaps are that
  // exact.
  double smallest_step = 1e-7;
  Exactness exactness = Exactness::kRounding;  // of the shapes on the way
};

struct FollowReport {
  FollowStatus status = FollowStatus::kFollowed;
  ClampedShape shape;   // at `fraction` of the way
  double fraction = 0;  // 1 when followed; otherwise the last place where the shape still holds
  int steps = 0;        // tried, refused ones included
};

// Moves the clamps of `from` to `to`, positions and angles linear in time, and follows the shape. A step is
// taken when Newton's method lands near the tangent predictor, and no eigenvalue of the second variation has
// changed sign. Throws std::logic_error when a number is not finite or `from` has no length.
[[nodiscard]] FollowReport follow(const Elastica& from, const ClampPair& to,
                                  const FollowOptions& options = {});

// Follows the shape on from one whose end is known, as that of a report is: this saves a third of the work
// of a small step.
[[nodiscard]] FollowReport follow_on(const ClampedShape& from, const ClampPair& to,
                                     const FollowOptions& options = {});

}  // namespace hotblade::elastica
