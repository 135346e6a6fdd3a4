// The flat circular arc that every strip starts at (docs/controller-protocol.md): its loop-free equilibrium
// is unique, so the blade's shape is known from its clamps alone.
#pragma once

namespace hotblade::robot {

// Half of what the arc turns by, rad.
inline constexpr double kFlatArcLeastHalfTurn_rad = 0.10, kFlatArcMostHalfTurn_rad = 0.17;
// How far a start pose may be off: far below what a second stable shape would need (tenths of a radian), far
// above rounding. The chord, over the blade's length, then follows to u du / 3.
inline constexpr double kFlatArcAngleSlack_rad = 1e-3, kFlatArcChordSlack = 1e-4;

}  // namespace hotblade::robot
