// Seams that cut a design into even parts.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "pipeline/plan/ribs/rib_axes.hpp"
#include "pipeline/plan/sweep/sweep_sections.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline {

// In the plane at `offset_mm`; the part lies towards smaller offsets with `side` 1, towards larger with -1.
[[nodiscard]] SweepSeam seam_across_sweep(const RibAxes& axes, double offset_mm, double side);

// Square to the ribs of the plane at `offset_mm`, at x mm along them; the part lies towards smaller x with
// `side` 1, towards larger with -1.
[[nodiscard]] SweepSeam seam_across_ribs(const RibAxes& axes, double offset_mm, double x_mm, double side);

// Returns so many equal shares of 1.
[[nodiscard]] std::vector<double> even_shares(std::size_t parts);

// Returns the ends of the parts inside an interval: one fewer than shares.
[[nodiscard]] std::vector<double> cuts(double from, double to, const std::vector<double>& shares);

// A range of offsets, or of x, in mm.
using Range = std::pair<double, double>;

// Return the seams of each of so many parts along the ribs, from small x to large.
//
// Even by width: across the ribs of the plane at `offset_mm`.
[[nodiscard]] std::vector<std::vector<SweepSeam>> even_widths(const RibAxes& axes, double offset_mm,
                                                              const Range& x_mm, std::size_t parts);
// Even by the length of what parallel planes between these offsets cut of a mesh, by the longest of several
// sections, each seam square to it: a tube that turns by more than half a turn is parted into arcs alike, and
// one that is closed into as many around it. None where the planes miss the mesh.
[[nodiscard]] std::vector<std::vector<SweepSeam>> even_lengths(const surface::TriangleMesh& mesh,
                                                               const RibAxes& axes, const Range& offsets_mm,
                                                               std::size_t parts);

}  // namespace hotblade::pipeline
