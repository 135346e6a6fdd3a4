// How far a clamp holds the blade from where the machine takes it to: what a calibration finds and a plan
// takes back.
//
// An offset is in the clamp's own axes: the blade's tangent from A to B, the in-plane normal, the plane's
// normal. The machine is told a pose; the clamp holds the blade shifted and turned from it. mm, rad.
#pragma once

#include <array>

#include "robot/pose/pose.hpp"

namespace hotblade::robot {

struct ClampOffset {
  std::array<double, 3> shift_mm{};  // of the place
  std::array<double, 3> turn_rad{};  // a rotation vector: about the tangent, about both normals
  [[nodiscard]] bool none() const { return *this == ClampOffset{}; }
  bool operator==(const ClampOffset&) const = default;
};

// Returns where a clamp holds the blade that was told a pose, and what it has to be told to hold the blade
// there: one undoes the other. Without an offset both return the pose itself, bit for bit.
[[nodiscard]] Pose held(const Pose& told, const ClampOffset& offset);
[[nodiscard]] Pose told(const Pose& held, const ClampOffset& offset);

// Of both clamps of a cell.
struct ClampOffsets {
  ClampOffset a, b;
  [[nodiscard]] bool none() const { return a.none() && b.none(); }
  bool operator==(const ClampOffsets&) const = default;
};
[[nodiscard]] ClampPoses held(const ClampPoses& told, const ClampOffsets& offsets);
[[nodiscard]] ClampPoses told(const ClampPoses& held, const ClampOffsets& offsets);

// Returns by how much both shifts together may change the distance between the clamps at most, mm.
[[nodiscard]] double reach_of(const ClampOffsets& offsets);

}  // namespace hotblade::robot
