// The controller's check of the blade: the equilibrium of every waypoint and on the way between two of them,
// as limit codes.
#pragma once

#include <optional>

#include "elastica/curve/elastica.hpp"
#include "robot/blade/blade.hpp"
#include "robot/blade/blade_branch.hpp"
#include "robot/pose/limits.hpp"
#include "robot/pose/waypoint.hpp"

namespace hotblade::robot {

struct BladeCheckOptions {
  bool equilibrium = true;  // false: nothing is checked, no shape is known
  double safety = 1;        // bending stress stays below OPEN's yield strength divided by this
  double min_margin = 1;    // smallest stability margin
};

// Of an executed waypoint: dimensionless, and the largest curvature of the blade, 1/mm.
struct BladeMargins {
  double margin = 0, curvature_per_mm = 0;
};

// Copyable, as LimitChecker: check a window on a copy. Never allocates but inside the curvature's evaluation.
class BladeCheck {
 public:
  BladeCheck() = default;  // checks nothing
  BladeCheck(const ClampedBlade& blade, const BladeCheckOptions& options);

  [[nodiscard]] bool checks() const { return on_; }
  // The next waypoint of a stream, and the pose halfway to it: between two waypoints in one plane each the
  // interpolated clamps are farthest out of one about there. The way in between is followed for snaps.
  [[nodiscard]] Limit next(const Waypoint& waypoint);
  // Any pose on the way, forwards or backwards.
  [[nodiscard]] Limit move_to(const Pose& a, const Pose& b);

  // The blade at the last pose, clamp A to clamp B, in the axes of clamp A; absent when it is not known.
  [[nodiscard]] std::optional<elastica::Elastica> shape() const;
  [[nodiscard]] std::optional<BladeMargins> margins();

 private:
  bool on_ = false, started_ = false;
  BladeBranch branch_;
  Pose last_a_, last_b_;
};

}  // namespace hotblade::robot
