// How nearly both clamps of a waypoint lie in one plane.
#pragma once

namespace hotblade::robot {

// Between planes that are not parallel, interpolated clamps leave their common plane; by more than this is no
// plan's (docs/controller-protocol.md).
inline constexpr double kMaxOffPlane_mm = 0.05;

}  // namespace hotblade::robot
