// How a sweep goes on past its end ribs: as it came, and within a short way no farther.
#pragma once

#include <algorithm>
#include <cmath>

namespace hotblade::pipeline {

// Turning and bending fade out over this way past an end rib, or past what they go on by there.
inline constexpr double kFadeMm = 10;
// The most that they go on by as they came: blade and clamps settle over twice the way that is left to fade.
inline constexpr double kMostOnMm = 10;

// Returns how far past an end rib turning and bending have gone where the sweep is `outside_mm` past it, in
// the same sense: as far up to `on_mm`, half of kFadeMm more from kFadeMm behind that on. Its first two
// derivatives have no jumps, so that clamps take no sudden acceleration there.
[[nodiscard]] inline double faded_mm(double outside_mm, double on_mm) {
  const double past_mm = std::abs(outside_mm) - on_mm;
  if (past_mm <= 0) return outside_mm;
  const double u = std::min(1.0, past_mm / kFadeMm);
  return std::copysign(on_mm + kFadeMm * (u - u * u * u + 0.5 * u * u * u * u), outside_mm);
}

}  // namespace hotblade::pipeline
