// Finds the heights at which the sections of a mesh part, join, begin or end: chains of ribs reach up to
// there, so planes are wanted just below and just above.
#pragma once

#include <span>
#include <vector>

#include "surface/slice/rib_links.hpp"

namespace hotblade::surface {

// Returns the offsets of the critical vertices in mm, ascending: those round which the surface does not
// simply pass from below to above (Banchoff 1967, "Critical points and curvature for embedded polyhedra"; at
// a border the half of that). Equal heights are told apart by vertex number, so a level edge is critical at
// most twice.
[[nodiscard]] std::vector<double> critical_heights(const TriangleMesh& mesh, const PlaneFamily& planes);

// Returns the offsets with planes added `inset_mm` below and above the critical heights between planes where
// chains of `nodes` end or begin. It takes at most four heights a gap, evenly chosen: a ragged border needs
// no more. Where there are none it returns `offsets` unchanged.
[[nodiscard]] std::vector<double> with_event_planes(const TriangleMesh& mesh, const PlaneFamily& planes,
                                                    std::span<const RibNode> nodes,
                                                    const std::vector<double>& offsets, double inset_mm);

}  // namespace hotblade::surface
