// How far two clamps are from holding the blade in one plane.
#pragma once

#include <span>

#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

// Returns the distance of clamp B's position from clamp A's plane, or what their normals' tilt makes over the
// chord where that is more, mm. robot::kMaxOffPlane_mm bounds it.
[[nodiscard]] double off_plane_mm(const Pose& a, const Pose& b);

// Returns the largest of these half-way between each pose and the next, where the error of interpolating the
// clamps is largest: positions linearly, orientations by slerp, as the controller does.
[[nodiscard]] double off_plane_mm(std::span<const BladePose> poses);

}  // namespace hotblade::pipeline
