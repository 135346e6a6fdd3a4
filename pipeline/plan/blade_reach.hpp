// How far any blade can follow a design to both sides of a place, whichever way it lies: what a fit that
// comes no nearer is held against.
//
// The cut that a blade leaves is a curve at each moment, bent to a limit k at most. Where such a curve passes
// within the tolerance t of a place P of the design and stays so to both sides for a length l, the design has
// points a and b with
//   |(a + b) / 2 - P| <= k l^2 / 2 + 2 t,  2 / k sin(k l / 2) - 2 t <= |a - P|, |b - P| <= l + 2 t:
// the curve's own three points fulfil it without t (the second difference of a curve of unit speed is k l^2
// at most, its chord the circle's at least), and each of the three is off by t at most. Where there are no
// such points no blade goes on along the design for l to both sides of P, in any planes; one that ends at P,
// or nearer to it than l, may follow it.
//
// The cut lies beside the blade by half its band. That the band is wider where the cut is steep against the
// blade's planes, which bends the cut otherwise than the blade, is left out.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::pipeline {

// What a blade leaves.
struct CutLimits {
  double tolerance_mm = 0;
  double curvature_per_mm = 0;  // largest of the cut
};

struct BladeReach {
  double half_mm = 0;  // no blade goes on along the design for so far to both sides
  Eigen::Vector3d at{0, 0, 0};
};

// Returns whether points a and b as above are proved not to be there, for `half_mm` (l): then no blade goes
// on through P for l to both sides. False where the design's border is nearer than l + 2 t, as a blade may
// leave the design there, and where curvature times l is over pi / 2. The surface is looked at by samples,
// whose spacing is allowed for.
[[nodiscard]] bool no_blade_follows(const surface::TriangleMesh& mesh, const Eigen::Vector3d& p,
                                    double half_mm, const CutLimits& limits);

// Returns the vertex within `around_mm` of a place that blades follow the least far, of some hundred that are
// looked at, and how far; none where nothing is proved of any.
[[nodiscard]] std::optional<BladeReach> shortest_reach(const surface::TriangleMesh& mesh,
                                                       const Eigen::Vector3d& place, double around_mm,
                                                       const CutLimits& limits);

}  // namespace hotblade::pipeline
