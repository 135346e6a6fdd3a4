// The controller's check of the blade: it follows the equilibrium to every waypoint and on the way between
// two of them, and says which limit breaks.
#pragma once

#include <optional>

#include "elastica/curve/elastica.hpp"
#include "robot/blade/blade.hpp"
#include "robot/blade/blade_branch.hpp"
#include "robot/pose/clamp_offset.hpp"
#include "robot/pose/limits.hpp"
#include "robot/pose/waypoint.hpp"

namespace hotblade::robot {

// What is checked, and how strictly.
struct BladeCheckOptions {
  bool equilibrium = true;  // false: nothing is checked, no shape is known
  double safety = 1;        // bending stress stays below OPEN's yield strength divided by this
  double min_margin = 1;    // smallest stability margin
  ClampOffsets offsets{};   // the clamps hold the blade so far from where they are told to be
};

// What an executed waypoint's shape has left: its stability margin, dimensionless, and the largest curvature
// of the blade, 1/mm.
struct BladeMargins {
  double margin = 0, curvature_per_mm = 0;
};

// Checks one stream of poses. It is copyable, as LimitChecker: check a window on a copy. It allocates nothing
// but inside the curvature's evaluation.
class BladeCheck {
 public:
  BladeCheck() = default;  // checks nothing
  BladeCheck(const ClampedBlade& blade, const BladeCheckOptions& options);

  // Returns whether the equilibrium is followed at all.
  [[nodiscard]] bool checks() const { return on_; }
  // Moves to the next waypoint of a stream over the pose halfway to it, and returns the limit that breaks:
  // between two waypoints in one plane each the interpolated clamps are farthest out of one about there. The
  // way in between is followed for snaps.
  [[nodiscard]] Limit next(const Waypoint& waypoint);
  // Moves to any pose on the way, forwards or backwards, and returns the limit that breaks.
  [[nodiscard]] Limit move_to(const ClampPoses& clamps);

  // Returns the blade at the last pose, clamp A to clamp B, in the axes of clamp A as it holds the blade;
  // absent when it is not known.
  [[nodiscard]] std::optional<elastica::Elastica> shape() const;
  // Returns what its shape has left; absent when it is not known.
  [[nodiscard]] std::optional<BladeMargins> margins();

 private:
  bool on_ = false, started_ = false;
  BladeBranch branch_;
  ClampOffsets offsets_;
  ClampPoses last_;
};

}  // namespace hotblade::robot
