// How far two clamps are from holding the blade in one plane.
#pragma once

#include <span>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Between non-parallel planes the interpolated clamps may leave a common plane by this much
// (docs/controller-protocol.md).
inline constexpr double kMaxOffPlaneMm = 0.05;

// The largest distance of clamp B's position from clamp A's plane, or of what their normals' tilt makes over
// the chord, mm.
[[nodiscard]] double off_plane_mm(const Pose& a, const Pose& b);

// Half-way between each pose and the next, clamps interpolated as the controller does: positions linearly,
// orientations by slerp. Its error is largest there.
[[nodiscard]] double off_plane_mm(std::span<const BladePose> poses);

}  // namespace hotblade::pipeline
