// Chooses where the first and the last section are taken, and where they lie: a border that is not quite
// parallel to the planes leaves the plane next to it a sliver of a section, which says nothing about the
// surface there.
#pragma once

#include <array>

#include "surface/slice/slice.hpp"

namespace hotblade::surface {

// Offsets in mm, of the first plane and the last one.
struct EndPlanes {
  std::array<double, 2> at{0, 0};  // end_inset_mm inside the design's extent
  std::array<double, 2> taken{
      0, 0};  // where the surface is cut to know the section there: at `at`, or behind it
};

// Returns the planes at both ends. A section is taken from the first of end_inset_mm, twice that, four times
// and so on at which no more than 0.2 % of its length is missing to that at the next one, at most a fifth of
// spacing_mm inside; where none is, as at a tip, it is taken from `at`. The mesh must have triangles.
[[nodiscard]] EndPlanes end_planes(const TriangleMesh& mesh, const PlaneFamily& planes,
                                   const SliceOptions& options);

// Moves the points of a section by its plane's way along the surface's tangent planes, straight across the
// section. They come to lie off the surface by half its curvature along the planes' normal times the square
// of the way.
void move_to_plane(SectionPiece& piece, const PlaneFamily& planes, double from_mm, double to_mm);

}  // namespace hotblade::surface
