// What a program's poses have to keep to, for both ways of reading them.
#pragma once

#include <cmath>
#include <limits>

#include "pipeline/program/json_node.hpp"
#include "pipeline/program/program.hpp"

namespace hotblade::pipeline {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr Range kAny{-kInfinity, kInfinity};
inline constexpr Range kPositive{0, kInfinity, true};
inline constexpr Range kNotNegative{0, kInfinity};
inline constexpr Range kLoad{-kLargestLoad, kLargestLoad};
inline constexpr Range kLoadSize{0, kLargestLoad};

// Unit vectors and quaternions written by other programs may carry nine digits or so.
inline constexpr double kUnitError = 1e-6;
// Lengths that have to agree are sums and differences of a few doubles; a micrometre per metre is far above
// rounding and far below anything a clamp can do.
inline constexpr double kLengthErrorRel = 1e-6;
// The controller counts microseconds in 32 bits.
inline constexpr Range kTime{0, 4294.967295};

inline long long microseconds(double seconds) {
  return std::llround(seconds * 1e6);
}
inline bool is_unit(double norm) {
  return std::abs(norm - 1) <= kUnitError;
}
inline bool is_square(double dot) {
  return std::abs(dot) <= kUnitError;
}
// Returns whether a pose's blade is as long as the strip's.
inline bool is_blade_length(double length, double blade_length) {
  return std::abs(length - blade_length) <= blade_length * kLengthErrorRel;
}
inline bool within_reach(double chord, double blade_length) {
  return chord <= blade_length * (1 + kLengthErrorRel);
}
// Returns the range of arc lengths in which a blade may form the design's surface.
inline Range foam_range(double blade_length) {
  const double slack = blade_length * kLengthErrorRel;
  return {-slack, blade_length + slack};
}

}  // namespace hotblade::pipeline
