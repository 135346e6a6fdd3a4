// The shape that two clamps give the blade, followed from pose to pose.
//
// A strip starts at a flat circular arc, whose loop-free equilibrium is unique (docs/controller-protocol.md).
// From there the clamps are told one after the other, and the equilibrium is followed
// (elastica/blade/continuation.hpp): where the blade is depends on the clamps alone. mm, rad.
#pragma once

#include <limits>

#include "elastica/blade/continuation.hpp"
#include "elastica/curve/elastica.hpp"
#include "robot/pose/limit.hpp"
#include "robot/pose/pose.hpp"

namespace hotblade::robot {

// By how much the distance between clamps told in whole micrometres may be off: half a count on each axis of
// both, sqrt(3) um.
inline constexpr double kRegisterRounding_mm = 1.7320508075688772e-3;

// Clamp B in the axes of clamp A, mm and rad, and how far it is from clamp A's plane, its tilt counted over
// the chord.
struct RelativeClamp {
  elastica::PlanarPose b;
  double off_plane_mm = 0;
};
// Of the turns from A to B, which are one orientation, that nearest to `near_rad` is given: between two poses
// a clamp turns by far less than half a turn.
[[nodiscard]] RelativeClamp seen_from_a(const ClampPoses& clamps, double near_rad);

// What the blade may be bent by.
struct BladeLimits {
  double max_curvature_per_mm = std::numeric_limits<double>::infinity();  // within yield
  double min_margin = 0;    // smallest stability margin (elastica/blade/stability.hpp)
  double off_plane_mm = 0;  // clamp B from clamp A's plane, its tilt counted over the chord
  double rounding_mm = 0;   // of a clamp's position: from this close to its length the blade counts as taut
  int margin_every = 16;    // poses from one margin to the next where nothing else asks for it
};

// What was found, with the amount and its bound in the limit's unit: kNone, or
// kStartPose    the first pose is no flat arc: which shape the blade has there is not known;
// kBladePlane   the clamps do not lie in one plane;
// kBladeReach   the clamps are farther apart than the blade reaches;
// kBladeSnap    the branch ends or loses stability on the way from the pose before;
// kBladeYield   it is bent beyond the largest curvature;
// kBladeMargin  it is stable, with less than the smallest margin.
struct BladeFinding {
  Limit limit = Limit::kNone;
  double value = 0, bound = 0;
  [[nodiscard]] bool held() const { return limit == Limit::kNone; }
};

// Follows the blade from pose to pose. It is plain data, cheap to copy: try on a copy, and keep the copy when
// it holds. It allocates nothing after construction but inside the curvature's evaluation, and throws nothing
// for finite poses.
class BladeBranch {
 public:
  BladeBranch() = default;
  BladeBranch(double length_mm, const BladeLimits& limits) : limits_(limits), length_mm_(length_mm) {}
  // Goes on from a shape that is known, in the axes of its clamp A.
  BladeBranch(const elastica::Elastica& known, const BladeLimits& limits);

  // Moves the clamps on; the first pose must be a flat arc. After a snap or beyond its reach the blade is
  // lost: every later call says the same. After the other findings it can be followed on.
  //
  // Curvature is checked at every pose, exactly where its bound does not settle it, stability by its index
  // all the way between two of them. The margin's value costs more than the shape: it is computed again as
  // soon as the shape has changed by what could bring it to the limit (kMarginPerBend), and at every pose of
  // BladeLimits::margin_every.
  BladeFinding move_to(const Pose& a, const Pose& b);

  // Returns whether the shape is no longer known.
  [[nodiscard]] bool lost() const { return lost_.limit != Limit::kNone; }
  // Returns the blade from clamp A to clamp B, in the axes of clamp A: from the origin along x.
  [[nodiscard]] const elastica::Elastica& shape() const { return shape_; }
  // Returns whether the blade is pulled straight within the clamps' rounding: its force along the chord
  // cannot be known then, and it is taken to be free of it.
  [[nodiscard]] bool taut() const { return taut_; }
  [[nodiscard]] double largest_curvature_per_mm() const;
  // Return the stability margin of the last shape that it was computed for, and of the present one.
  [[nodiscard]] double margin() const { return margin_; }
  double exact_margin();
  // Returns how far clamp B was from clamp A's plane at the last pose, its tilt counted over the chord.
  [[nodiscard]] double off_plane_mm() const { return off_plane_mm_; }
  // Returns whether clamps at these poses certainly leave the blade within its limits of curvature and
  // margin, by how far the last shape was from them and what the way there bends it by, to first order and a
  // fifth more; false where only a look at them can say. They have to be near: nothing is followed.
  [[nodiscard]] bool far_from_limits(const Pose& a, const Pose& b) const;

 private:
  BladeFinding start(const elastica::PlanarPose& b);
  BladeFinding bend_to(const elastica::PlanarPose& b);
  BladeFinding pull_taut(const elastica::PlanarPose& b, double chord);
  BladeFinding follow_by(const elastica::FollowReport& way, const elastica::PlanarPose& b);
  BladeFinding check_limits();
  [[nodiscard]] bool margin_holds(double more_bend) const;
  BladeFinding lose(Limit limit, double value, double bound);

  BladeLimits limits_;
  double length_mm_ = 0;
  bool started_ = false, taut_ = false;
  elastica::Elastica shape_;
  elastica::ClampedShape followed_;  // shape_ with its end, where it was followed; else without a length
  double theta_ = 0;                 // of clamp B against clamp A, not modulo 2 pi
  double off_plane_mm_ = 0;
  double margin_ = 0;
  elastica::Elastica margin_shape_;  // that the margin was computed for
  int poses_since_margin_ = 0;
  BladeFinding lost_;
};

// A margin sinks to values below kMarginBoundHolds by at most this, times 1 + force times length^2 / 10, for
// a unit change of the shape's bend: |d kappa| l + (|d lambda1| + |d lambda2|) l^2 / 2. Measured on random
// stable shapes, with a factor to spare (tests/robot/blade/blade_branch_test.cpp). Above, where blades are
// nearly straight, it may change faster: limits up there are looked at in every pose.
inline constexpr double kMarginPerBend = 40, kMarginBoundHolds = 20;

// Returns the size of the change from one shape to another of the same length, both in the axes of their
// clamp A.
[[nodiscard]] double bend_between(const elastica::Elastica& p, const elastica::Elastica& q);

// Returns a bound of |kappa| over the elastica: kappa^2 / 2 - lambda1 cos theta - lambda2 sin theta is the
// same all along an elastica, so kappa^2 is largest where the tangent points along the force, whether or not
// it does so somewhere. The bound is exact for circular arcs.
[[nodiscard]] double curvature_bound(const elastica::Elastica& e);

}  // namespace hotblade::robot
