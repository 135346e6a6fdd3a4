// Which folds are creases, by how far they turn.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface/slice/creases.hpp"

namespace hotblade::surface {

// How wide bands are at most that are left out between faces. Strips go on past their faces by 4 mm.
inline constexpr double kMostBandMm = 8;

class FoldLimits {
 public:
  // A walk ends here: no strip's seam is farther from another crease that would matter.
  static constexpr double kFarMm = 400;
  // A surface keeps its direction as long as it turns by less than this share of the fold.
  static constexpr double kKept = 0.25;

  explicit FoldLimits(const CreaseLimits& limits) : limits_(limits) {}

  // A chord's height over an arc that turns by the fold: on less than this, divided by the fold, to both
  // sides an edge may stand for a bend. On more no elastica follows both: the best even function with three
  // coefficients misses what is straight but for a fold in its middle by a thirtieth of a side times the
  // fold, here a tolerance.
  [[nodiscard]] double wide_mm(double fold) const { return 8 * kChords * limits_.tolerance_mm / fold; }

  // Whether the least radius rounds a fold within the tolerance: the arc that is tangent to both sides misses
  // the edge by twice this; a fit shares it out to both sides.
  [[nodiscard]] bool rounds_off(double fold) const {
    return !(0.5 * limits_.least_radius_mm * (1 / std::cos(0.5 * fold) - 1) > limits_.tolerance_mm);
  }

  // Whether a fold is one that may be a crease, or a shallow one where these are asked for.
  [[nodiscard]] bool counts(double fold) const {
    return !rounds_off(fold) || (limits_.shallow && wide_mm(fold) < kFarMm);
  }

  // Folds of no more than this do not count. What folds less stands alone only if sides are seen through for
  // longer than walks are.
  [[nodiscard]] double least_rad() const {
    const double rounded = 2 * std::acos(1 / (1 + 2 * limits_.tolerance_mm / limits_.least_radius_mm));
    return limits_.shallow ? std::min({rounded, wide_mm(kFarMm), std::numbers::pi}) : rounded;
  }

 private:
  // Tolerances that the chords of a mesh may be off its smooth surface, as those of coarse shells are.
  static constexpr double kChords = 4;

  CreaseLimits limits_;
};

}  // namespace hotblade::surface
