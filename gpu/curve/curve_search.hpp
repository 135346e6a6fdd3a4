// Cuts a curve into pieces for nearest-point queries, and searches for points whose nearest place the kernels
// do not prove.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "gpu/kernels/curve_pieces.h"

namespace hotblade::gpu {

struct CurvePieces {
  Eigen::Vector2d origin{0, 0};  // of the pieces' frame
  double scale = 1;              // into it, a power of two: the curve lies in [-1, 1]^2
  std::vector<hb_curve_piece> pieces;
  std::optional<hb_curve_whole> whole;  // where the curve is one polynomial
  double sag = 0;                       // largest of the pieces
  [[nodiscard]] Eigen::Vector2d local(const Eigen::Vector2d& point) const { return (point - origin) * scale; }
};

// Both return the curve's pieces. Control points are finite (std::logic_error otherwise). The parameter is a
// cubic's own in [0, 1], or i + u on quadratic i of at least one.
[[nodiscard]] CurvePieces pieces_of_cubic(const std::array<Eigen::Vector2d, 4>& control);
[[nodiscard]] CurvePieces pieces_of_quadratics(std::span<const std::array<Eigen::Vector2d, 3>> chain);

struct CurveNearest {
  double distance = 0, t = 0;
};

// Returns the nearest place to one finite point, by branch and bound, all in the curve's frame: right for
// every curve, to `rounding` of the size.
[[nodiscard]] CurveNearest nearest_by_search(const CurvePieces& curve, const Eigen::Vector2d& local_point,
                                             double rounding);

}  // namespace hotblade::gpu
