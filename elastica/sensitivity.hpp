// What a clamp's error does to the shape: how far the blade moves, and how large an error it takes to lose
// it.
//
// Units: mm, rad.
#pragma once

#include <array>

#include "elastica/continuation.hpp"

namespace hotblade::elastica {

// One coordinate of one clamp, in the order of Sensitivity's arrays: along and across clamp A's tangent, turn
// of A, then the same of clamp B in its own axes.
enum class ClampCoordinate { kAlongA, kAcrossA, kTurnA, kAlongB, kAcrossB, kTurnB };

struct SensitivityOptions {
  double position_error_mm = 0.1;
  double angle_error_rad = 1e-3;
};

struct Sensitivity {
  // Largest displacement of a point of the blade, mm, for the error of each coordinate, to first order: the
  // displacement at equal arc length. Infinite where the shape is lost (its fields are singular).
  std::array<double, 6> displacement_mm{};
  // All six errors at once at their worst signs bring at most this.
  double total_mm = 0;
};

// The derivative of the shape by the clamps, from the Jacobi fields. Throws std::logic_error as end_map()
// does.
[[nodiscard]] Sensitivity sensitivity(const Elastica& elastica, const SensitivityOptions& options = {});

struct ClampMarginOptions {
  // Errors of this size and more are not looked into.
  double largest_mm = 50;
  // A turn of one rad counts as this many mm; 0 takes half the blade's length, the largest move that a turn
  // about its middle gives.
  double mm_per_rad = 0;
};

struct ClampMargin {
  // Smallest error found that loses the shape, largest_mm when none was found: a local minimum of the
  // distance to the folds, so an upper bound of the true one. Exact to 1e-4 of largest_mm, on the safe side.
  double margin_mm = 0;
  // The error of clamp B against clamp A that loses it: along and across A's tangent in mm, turn in rad.
  std::array<double, 3> error{};
};

// How far clamp B may err against clamp A before a stable shape snaps; 0 for a shape that is not stable.
// Errors of A alone are the same seen from B, a turn apart.
[[nodiscard]] ClampMargin clamp_margin(const Elastica& elastica, const ClampMarginOptions& options = {});

}  // namespace hotblade::elastica
