// Planar cubic Bezier curves: evaluation, arc length, and the least-squares cubic of a polyline.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace hotblade::elastica {

using Bezier = std::array<Eigen::Vector2d, 4>;

struct BezierPoint {
  Eigen::Vector2d p, d1, d2;  // position, first and second derivative by t
};

// The point at t with its derivatives; t may lie outside [0, 1].
[[nodiscard]] BezierPoint evaluate(const Bezier& bezier, double t);

// The signed curvature at a point; 0 where the derivative vanishes.
[[nodiscard]] double curvature(const BezierPoint& point);

// Cumulative arc length at t = 0, 1/n .. 1 (n + 1 values), each interval by 5-point Gauss quadrature.
[[nodiscard]] std::vector<double> arc_lengths(const Bezier& bezier, int n);

// n >= 2 parameters at which the curve is evenly spaced by arc length, ends included.
[[nodiscard]] std::vector<double> even_parameters(const Bezier& bezier, int n);

// The cubic through the first and last point that is nearest to all points in least squares: its inner
// control points are free, and parameters are projected anew until they settle. There must be at least 4
// points and distinct ends (std::logic_error).
struct BezierFit {
  Bezier bezier;
  double rms = 0, max = 0;  // distances of the points to the curve, unit of the input
};
[[nodiscard]] BezierFit fit_bezier(std::span<const Eigen::Vector2d> points);

}  // namespace hotblade::elastica
