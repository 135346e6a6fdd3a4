// The lambda-residual: how far the curvature of a cubic Bezier is from being affine in position, as an
// elastica's is.
//   e = sqrt( min over (lambda1, lambda2, alpha) of Int (kappa + lambda1 y - lambda2 x - alpha)^2 ds / Int
//   kappa^2 ds )
// (Brander, Bærentzen, Fisker, Gravesen, "Bezier curves that are close to elastica", section 2.) It is
// invariant under similarity. It guides a design; what is accepted is decided in mm against a true elastica.
#pragma once

#include <cstdint>

#include "elastica/bezier/bezier.hpp"
#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

enum class ResidualStatus : std::uint8_t {
  kOk,
  kStraight,  // the control points lie on a line: e = 0 by definition
  kCusp,  // the derivative vanishes, at an end of zero edge length or inside: Int kappa^2 ds diverges, and
          // e goes to 1 as the curve nears this
  kNotFinite,  // a coordinate is NaN, infinite, or beyond 1e140
};

// Returns the word for a status.
[[nodiscard]] constexpr const char* name(ResidualStatus status) {
  constexpr const char* kNames[] = {"ok", "straight", "cusp", "not_finite"};
  return kNames[static_cast<int>(status)];
}

// Whether a residual of this status has a value (0 for a straight line).
[[nodiscard]] constexpr bool has_value(ResidualStatus status) {
  return status == ResidualStatus::kOk || status == ResidualStatus::kStraight;
}

struct LambdaResidual {
  double value = 0;                            // e in [0, 1]
  double bound = 0;                            // |value - e| at most
  double lambda1 = 0, lambda2 = 0, alpha = 0;  // kappa ~ alpha - lambda1 y + lambda2 x
  ResidualStatus status = ResidualStatus::kOk;
};

// The residual by 24-point Gauss quadrature, on one panel where its error bound is below 1e-9, else on panels
// graded towards the roots of B' (elastica/kernels/graded_residual.h). The bound holds quadrature and
// rounding; it is below 1e-9 but for curves whose polygon is nearly straight or whose speed nearly vanishes,
// of which the digits of the coordinates say less. elastica/bezier/residual_batch.hpp does many curves at
// once.
[[nodiscard]] LambdaResidual lambda_residual(const Bezier& bezier);

// The elastica of the fitted (lambda1, lambda2, alpha), which starts at the Bezier's start with its tangent
// and has its length: the paper's first guess for a fit.
[[nodiscard]] Elastica first_guess(const Bezier& bezier, const LambdaResidual& residual);

}  // namespace hotblade::elastica
