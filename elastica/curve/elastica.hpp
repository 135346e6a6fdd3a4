// Planar elastic curves (elastica) in state form.
//
// An elastica is the shape of a thin blade bent in its plane: its curvature is affine in position,
//   theta' = kappa - lambda1 (y - y0) + lambda2 (x - x0),  x' = cos theta,  y' = sin theta,
// by arc length s from the start state (x0, y0, theta, kappa). The state form is smooth through lines,
// circles, and curves with and without inflections (docs/elastica.md; Brander, Gravesen, Nørbjerg 2017).
// Units: any length unit; kappa 1/length, lambda 1/length^2, angles in rad.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "elastica/curve/taylor.hpp"

namespace hotblade::elastica {

// A segment: start state, force parameters and arc length. Plain data, as it stands in program files.
struct Elastica {
  double x = 0, y = 0, theta = 0;
  double kappa = 0;
  double lambda1 = 0, lambda2 = 0;
  double length = 0;
};

// One point of a curve with its tangent direction and signed curvature.
struct CurvePoint {
  double x = 0, y = 0, theta = 0, kappa = 0;
  [[nodiscard]] Eigen::Vector2d position() const { return {x, y}; }
  [[nodiscard]] Eigen::Vector2d tangent() const;
};

// An elastica expanded once into Taylor pieces; evaluates anywhere in [0, length] to rounding
// (2e-12 of the length over three periods, tested against the closed form).
class ElasticaCurve {
 public:
  // Throws std::logic_error when a parameter is not finite, length is negative, or the curve winds so tightly
  // that it would need more than kMaxPieces pieces.
  explicit ElasticaCurve(const Elastica& elastica);

  // The point at arc length s; s is clamped to [0, length].
  [[nodiscard]] CurvePoint at(double s) const;
  [[nodiscard]] const Elastica& elastica() const { return elastica_; }
  // The largest |kappa| on the segment, exact to 1e-6 of itself.
  [[nodiscard]] double max_abs_curvature() const;

  static constexpr int kMaxPieces = 4096;

 private:
  struct Piece {
    TaylorPiece<double> series;
    double x0, y0;
  };
  Elastica elastica_;
  double step_ = 0;
  std::vector<Piece> pieces_;
};

// A bound of how far `length` of the curve turns, rad, which also measures what its evaluation costs; NaN
// where a parameter is not finite. ElasticaCurve refuses about a thousand turns.
[[nodiscard]] double turns_at_most(const Elastica& elastica, double length);

// The points at n >= 2 even arc lengths, both ends included.
[[nodiscard]] std::vector<CurvePoint> sample(const Elastica& elastica, int n);

// The point at any arc length; before 0 and beyond `length` the curve is extended along itself.
[[nodiscard]] CurvePoint point_at(const Elastica& elastica, double s);

// The part of the curve from arc length s0 to s1 >= s0; where either lies outside [0, length], the curve is
// extended along itself.
[[nodiscard]] Elastica segment(const Elastica& elastica, double s0, double s1);

// The curve run through from its end to its start.
[[nodiscard]] Elastica reversed(const Elastica& elastica);

}  // namespace hotblade::elastica
