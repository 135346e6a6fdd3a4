// Where a strip's block may stand in a cell, and how well both arms would serve it there.
#pragma once

#include <array>
#include <vector>

#include "pipeline/program/program.hpp"
#include "robot/arm/arm.hpp"
#include "robot/arm/cell.hpp"

namespace hotblade::pipeline {

// Where a block may stand, and which arm holds clamp A.
struct ArmPlace {
  double raise_mm = 0;
  bool swapped = false;                      // the second arm holds clamp A
  double dx_mm = 0, dy_mm = 0, yaw_rad = 0;  // turned about the cell's vertical axis, then moved
};

// Returns the strip's place in the cell, turned, moved and raised; and what it was before.
[[nodiscard]] Pose placed(const Pose& design_to_cell, const ArmPlace& place);
[[nodiscard]] Pose unplaced(const Pose& design_to_cell, const ArmPlace& place);

// How far a block is moved, mm; a degree counts as 5 mm.
[[nodiscard]] double moved_mm(const ArmPlace& place);

// Returns the heights of a range, the lowest first, both ways of holding the blade at each.
[[nodiscard]] std::vector<ArmPlace> heights(const robot::PlaceRange& range);

// Returns the places of the search: heights, turns and shifts, but for those of the heights alone. A turn by
// half a circle does what changing the arms does.
[[nodiscard]] std::vector<ArmPlace> grid(const robot::PlaceRange& range);

// What does not change from pose to pose of an arm that holds a clamp: clamp A as it is, clamp B turned by
// 180 degrees about its plane's normal, a flipped jaw by 180 degrees about the blade's tangent besides.
struct Hold {
  Eigen::Isometry3d cell_to_base, jaw;
  Eigen::Isometry3d in_clamp;  // the jaw in the clamp's frame
  // Returns the flange in the arm's base_link.
  [[nodiscard]] Eigen::Isometry3d flange(const Pose& clamp) const;
};
[[nodiscard]] Hold hold_of(const robot::CellArm& arm, const Pose& design_to_cell, bool clamp_b, bool flip);

// How far margins go before more of them makes a place no better: 20 degrees of joints and wrist, 10 of the
// elbow, 200 mm of the shoulder. Returns the least as a share; negative beyond a joint's limit.
[[nodiscard]] double share_of_good(double joint_rad, double wrist_rad, double elbow_rad, double shoulder_mm);

// Scores places of one strip by every 150th pose.
class PlaceScorer {
 public:
  // Both must outlive the scorer.
  PlaceScorer(const Strip& strip, const robot::Cell& cell);

  // Returns how good a place is, 1 or more is good enough in everything: the least share of what is good of
  // both arms' best branches. Negative: a pose is out of reach or a joint's limit is broken.
  [[nodiscard]] double operator()(const ArmPlace& place) const;

 private:
  [[nodiscard]] double best_of(std::size_t arm, bool clamp_b, const Pose& design_to_cell) const;
  [[nodiscard]] double best_along(std::size_t arm, const std::vector<Eigen::Isometry3d>& jaws,
                                  const Eigen::Isometry3d& design_to_base, bool both_ways) const;

  const Strip& strip_;
  const robot::Cell& cell_;
  // By arm, clamp and way round: the flange in the design's frame.
  std::array<std::array<std::array<std::vector<Eigen::Isometry3d>, 2>, 2>, 2> flanges_;
  std::array<bool, 2>
      turned_by_axis_6_{};  // by arm: a flipped jaw is one that joint 6 turns by half a circle
};

}  // namespace hotblade::pipeline
