// Computes the distances from many points in a plane to one curve: a cubic Bezier, or a chain of quadratic
// ones (an elastica: elastica/quadratic/quadratic_chain.hpp gives its chain and how far it strays).
//
// Promise of every backend: the distance is within kErrorRel of the true one to that curve, relative to the
// largest coordinate that takes part (the curve's and the point's, from the curve's first control point), and
// the parameter is of a point that near. Cusps, loops, straight, folded and single-point curves too. Backends
// and instruction sets may differ by that; the number of threads and the other points of the call change no
// bit.
//
// How: kernels/curve_nearest.h proves most answers by convexity; the rest gets a branch-and-bound search on
// the host (curve_search.hpp).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "gpu/backend/backend.hpp"

namespace hotblade::gpu {

// Holds a curve prepared for queries; control points are finite, in any unit. Concurrent queries are safe.
class CurveDistance {
 public:
  // The parameter t of an answer is the cubic's own, or i + u at u on quadratic i. Both throw
  // std::logic_error when a coordinate is not finite, there is no quadratic, or one does not begin where the
  // one before ends.
  [[nodiscard]] static CurveDistance to_cubic(const std::array<Eigen::Vector2d, 4>& control,
                                              Backend backend = Backend::kCpu);
  [[nodiscard]] static CurveDistance to_quadratics(std::span<const std::array<Eigen::Vector2d, 3>> chain,
                                                   Backend backend = Backend::kCpu);
  ~CurveDistance();
  CurveDistance(CurveDistance&&) noexcept;
  CurveDistance& operator=(CurveDistance&&) noexcept;

  // Point i is (x[i], y[i]); writes its distance to the curve and the parameter of a nearest point (of
  // several, any). Runs on all cores allowed. Returns how many points needed the careful search. Throws
  // std::logic_error when the spans differ in size. A point that is not finite gets NaN.
  std::size_t query(std::span<const double> x, std::span<const double> y, std::span<double> distance,
                    std::span<double> t) const;

  // Returns what answered the last query, and why.
  [[nodiscard]] BackendUse used() const;

  static constexpr double kErrorRel = 1e-14;

 private:
  struct Impl;
  explicit CurveDistance(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hotblade::gpu
