// The shape that a strip's clamps give the blade, found from the clamp poses alone.
//
// Waypoint 0 holds a flat circular arc, whose loop-free equilibrium is unique (docs/controller-protocol.md).
// From there the equilibrium is followed from waypoint to waypoint (robot/blade/blade_branch.hpp), and over
// the pose halfway to each wherever the blade could be at a limit there, with the clamps as the controller
// reads them from its registers, to the end of the strip: whether the blade snaps, yields or could snap is
// judged as the controller judges it. The program's own shapes are only compared with what is found. Where
// micrometres alone bring a nearly straight blade away from them, it is asked once more where the clamps as
// computed hold it.
#pragma once

#include <string>
#include <vector>

#include "pipeline/program/program.hpp"
#include "pipeline/verify/refusal.hpp"
#include "pipeline/verify/row_bounds.hpp"

namespace hotblade::pipeline {

struct BranchOptions {
  double max_curvature_per_mm = 0;  // of the blade within yield
  double min_margin = 0;            // smallest accepted stability margin
  robot::ClampOffsets offsets{};    // the clamps hold the blade so far from where they are told to be
};

// What was found of a strip: kNone when the blade stays on one stable branch from the flat arc to the end,
// the program's own, within yield; a limit of robot/blade/blade_branch.hpp; or kPlannedShape, when the blade
// is not where the program says.
struct BranchReport {
  Limit limit = Limit::kNone;
  std::size_t pose = 0;         // of the finding; 0 when held
  double value = 0, bound = 0;  // the amount and its limit, in the unit of the limit
  // Largest distance of the blade, its clamps in whole micrometres, from where the program says, as far as
  // followed.
  double mismatch_mm = 0;
  // The same of what is in foam and forms the design, across the blade, taut ones too: what the controller's
  // micrometres add to the cut.
  double told_off_mm = 0;
  // That of each pose in each part of the blade, as far as followed; of hot poses that form no design, of
  // what the nearest in foam forms.
  PartsOff told_off;
  double smallest_margin = 0;  // of the shapes found, as often as robot/blade/blade_branch.hpp computes it
  double largest_curvature_per_mm = 0;
  [[nodiscard]] bool held() const { return limit == Limit::kNone; }
  std::size_t taut_poses = 0;  // pulled straight, where the clamps decide the shape to second order only
};

// Returns a finding that is not kNone as a refusal: strip, rib, limit by phase and time, amount.
[[nodiscard]] Refusal branch_refusal(const Strip& strip, const BranchReport& report);

// More, by the clamps as computed, is another shape than the program's; less is rounding of poses.
inline constexpr double kShapeMismatchMm = 0.02;

[[nodiscard]] BranchReport follow_branch(const Strip& strip, const BranchOptions& options);

// The rib being cut at a pose, or the nearest one in time while cutting; empty in other phases.
[[nodiscard]] std::string rib_at(const Strip& strip, std::size_t pose);

// Returns the rib of a strip whose plane is nearest to a place in the design frame; empty where it has none.
[[nodiscard]] std::string nearest_rib(const Strip& strip, const Eigen::Vector3d& at);

}  // namespace hotblade::pipeline
