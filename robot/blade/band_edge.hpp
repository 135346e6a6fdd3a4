// Where the edge of the band lies that a blade of some width melts.
#pragma once

#include <algorithm>
#include <cmath>

namespace hotblade::robot {

// Returns how much farther than half the band of a blade that moves square to its width the band's edge lies
// from the blade's middle line, mm, along the unit normal n of the surface that is left: the largest
//   |along| t + bend t^2 / 2,  0 <= t <= width / 2.
// `along` is n . N, N the unit direction of the width, and `bend` the surface's normal curvature where the
// width passes over it, its second fundamental form of N - (n . N) n, positive where it rises towards the
// blade: over a hollow both edges of the width touch, over a crest the place between them does. To find the
// edge from the surface of the middle lines, `bend` is minus that surface's. Sharper hollows than a width's
// are taken as of that radius: no blade goes into them.
[[nodiscard]] inline double over_width_mm(double along, double bend_per_mm, double width_mm) {
  const double half = 0.5 * width_mm, slope = std::abs(along);
  if (!(half > 0)) return 0;
  const double bend = std::min(bend_per_mm, 1 / width_mm);
  if (bend < 0 && slope < -bend * half) return 0.5 * slope * slope / -bend;
  return half * (slope + 0.5 * bend * half);
}

}  // namespace hotblade::robot
