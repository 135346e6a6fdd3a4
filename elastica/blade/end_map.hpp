// The far end of a blade, and how it moves when the start curvature and the end force change.
//
// The three Jacobi fields of the start state (derivatives of the curve by kappa, lambda1, lambda2 with the
// start clamp held) are carried along the curve by the same Taylor recurrence as the curve itself. At the end
// they are the derivatives that Newton's method needs; their determinant along the curve vanishes at the
// conjugate points, and their Schur complement counts the negative eigenvalues of the second variation
// (docs/elastica.md, Stability).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "elastica/kernels/simd.hpp"

namespace hotblade::elastica {

// The derivatives of (x, y, theta) (rows) at one point by (kappa, lambda1, lambda2) (columns).
struct JacobiFields {
  double s = 0;  // arc length
  CurvePoint point;
  Eigen::Matrix3d fields = Eigen::Matrix3d::Zero();
  Eigen::RowVector3d rates = Eigen::RowVector3d::Zero();  // of the theta row, d/ds
  // The number of negative eigenvalues of the second variation with clamps at the start and here.
  int index = 0;
};

// How exact an end is: to rounding, or to 1e-8 of the blade's length and of its turning, in 0.6 of the time,
// for searches that ask for thousands.
enum class Exactness { kRounding, kSearch };

// The fields at the end alone. Throws std::logic_error as ElasticaCurve does.
[[nodiscard]] JacobiFields end_map(const Elastica& elastica, Exactness exactness = Exactness::kRounding,
                                   Simd simd = best_simd());

// The fields at the ends of the Taylor pieces, the last being the end of the curve. Between two of them d
// theta/d kappa, which vanishes at most once in pi/sqrt(|lambda|), changes sign at most once. There are
// `at_least` pieces or more.
[[nodiscard]] std::vector<JacobiFields> jacobi_fields(const Elastica& elastica, int at_least = 1,
                                                      Simd simd = best_simd());

}  // namespace hotblade::elastica
