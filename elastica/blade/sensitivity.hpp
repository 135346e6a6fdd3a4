// What a clamp's error does to the shape: how far the blade moves, to first order.
//
// Units: mm, rad.
#pragma once

#include <array>
#include <limits>

#include "elastica/blade/continuation.hpp"

namespace hotblade::elastica {

// One coordinate of one clamp, in the order of Sensitivity's arrays: along and across clamp A's tangent, turn
// of A, then the same of clamp B in its own axes.
enum class ClampCoordinate { kAlongA, kAcrossA, kTurnA, kAlongB, kAcrossB, kTurnB };

struct SensitivityOptions {
  double position_error_mm = 0.1;
  double angle_error_rad = 1e-3;
  // Arc lengths of the part whose total is asked for; the whole blade.
  double from_mm = 0, to_mm = std::numeric_limits<double>::infinity();
};

struct Sensitivity {
  // The largest displacement of a point of the blade, mm, for the error of each coordinate, to first order
  // and at equal arc length. It is infinite where the shape is lost (its fields are singular).
  std::array<double, 6> displacement_mm{};
  // What all six errors at once, at the signs that are worst for a point of the part, move that point across
  // the blade, the largest of all: what moves it along the blade does not change what it cuts.
  double total_mm = 0;
};

// The displacements that the errors bring, by the derivative of the shape by the clamps, from the Jacobi
// fields. Throws std::logic_error as end_map() does.
[[nodiscard]] Sensitivity sensitivity(const Elastica& elastica, const SensitivityOptions& options = {});

// The height by which a blade bows between aligned clamps whose chord is shorter than it by `slack`.
[[nodiscard]] double straight_bow(double length, double slack);

// How far, in mm, the errors of both clamps at once move a nearly straight blade, where displacement grows
// with the square root of an error along it and derivatives say nothing: pushed together or pulled apart by
// twice the position error, turned at both ends, moved across. With `keeps_side` false it may also bow to
// the other side. The result is right to leading order in slack over length.
[[nodiscard]] double straight_response_mm(double length, double slack, bool keeps_side,
                                          const SensitivityOptions& options = {});

}  // namespace hotblade::elastica
