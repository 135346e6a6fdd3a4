// Distance from many points in a plane to one cubic Bezier.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "gpu/kernels/cubic_nearest.h"

namespace hotblade::gpu {

// The curve cut into chords, in a frame with its first control point as the origin.
[[nodiscard]] CubicChords make_chords(const std::array<Eigen::Vector2d, 4>& control);

// A cubic prepared for queries: control points finite, in any unit; cusps, loops, straight and single-point
// curves too. Safe for concurrent queries.
class CubicDistance {
 public:
  // Throws std::logic_error when a coordinate is not finite.
  explicit CubicDistance(const std::array<Eigen::Vector2d, 4>& control);

  // Point i is (x[i], y[i]); writes its distance to the curve and the parameter of a nearest point (of
  // several, any). Runs on all cores allowed. Returns how many points needed the careful search. Throws
  // std::logic_error when the spans differ in size. A point that is not finite gets NaN.
  std::size_t query(std::span<const double> x, std::span<const double> y, std::span<double> distance,
                    std::span<double> t) const;

  // Of the largest coordinate that takes part, relative to the curve's first control point.
  static constexpr double kErrorRel = 1e-14;

 private:
  CubicChords chords_;
  Eigen::Vector2d origin_;
};

}  // namespace hotblade::gpu
