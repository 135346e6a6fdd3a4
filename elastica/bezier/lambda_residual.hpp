// The lambda-residual: how far the curvature of a cubic Bezier is from being affine in position, as an
// elastica's is.
//   e = sqrt( min over (lambda1, lambda2, alpha) of Int (kappa + lambda1 y - lambda2 x - alpha)^2 ds / Int
//   kappa^2 ds )
// (Brander, Bærentzen, Fisker, Gravesen, "Bezier curves that are close to elastica", section 2.) Invariant
// under similarity. A design-time guide: acceptance is in mm against a true elastica.
#pragma once

#include <cstdint>

#include "elastica/bezier/bezier.hpp"
#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

enum class ResidualStatus : std::uint8_t {
  kOk,
  kStraight,   // the control points lie on a line: e = 0 by definition
  kCusp,       // the derivative vanishes, at an end of zero edge length or inside: Int kappa^2 ds diverges
  kNotFinite,  // a coordinate is NaN, infinite, or beyond 1e140
};

// The residual has a value (0 for a straight line).
[[nodiscard]] constexpr bool has_value(ResidualStatus status) {
  return status == ResidualStatus::kOk || status == ResidualStatus::kStraight;
}

struct LambdaResidual {
  double value = 0;                            // e in [0, 1]
  double lambda1 = 0, lambda2 = 0, alpha = 0;  // kappa ~ alpha - lambda1 y + lambda2 x
  ResidualStatus status = ResidualStatus::kOk;
};

// 24-point Gauss quadrature: error below 1e-9 where the speed |B'| stays above a tenth of its mean.
// Many curves at once: elastica/bezier/residual_batch.hpp.
[[nodiscard]] LambdaResidual lambda_residual(const Bezier& bezier);

// The elastica of the fitted (lambda1, lambda2, alpha), started at the Bezier's start with its tangent and
// length: the paper's first guess for a fit.
[[nodiscard]] Elastica first_guess(const Bezier& bezier, const LambdaResidual& residual);

}  // namespace hotblade::elastica
