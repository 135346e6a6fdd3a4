// How a sweep goes on past its end ribs: as it came, and within a short way no farther.
#pragma once

#include <algorithm>
#include <cmath>

namespace hotblade::pipeline {

// Turning and bending fade out over this way past an end rib.
inline constexpr double kFadeMm = 10;

// Returns how far past an end rib turning and bending have gone where the sweep is `outside_mm` past it, in
// the same sense: as far at first, half of kFadeMm from kFadeMm on. Its first two derivatives have no jumps,
// so that clamps take no sudden acceleration there.
[[nodiscard]] inline double faded_mm(double outside_mm) {
  const double u = std::min(1.0, std::abs(outside_mm) / kFadeMm);
  return std::copysign(kFadeMm * (u - u * u * u + 0.5 * u * u * u * u), outside_mm);
}

}  // namespace hotblade::pipeline
