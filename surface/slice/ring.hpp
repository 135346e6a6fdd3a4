// Cuts designs open that go all the way round a fan's axis, so that offsets rise from one end to the other.
#pragma once

#include "surface/slice/plane_family.hpp"

namespace hotblade::surface {

// Returns the mesh cut along the half plane opposite to offset 0: faces that straddle it are split there, and
// the two sides of the cut hold vertices of their own, a billionth of a radian off it, so that every vertex's
// offset tells on which side it lies. Other vertices and faces are kept as they are, in their order. The axis
// must keep clear of the mesh (fan_about), which must have triangles.
[[nodiscard]] TriangleMesh cut_open(const TriangleMesh& mesh, const PlaneFamily& fan);

}  // namespace hotblade::surface
