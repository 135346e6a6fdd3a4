// Is a clamped blade's shape stable? The second variation of the bending energy with both clamps held.
//
// H = -d^2/ds^2 - (lambda1 cos theta + lambda2 sin theta) on variations of theta that vanish at both ends and
// keep the end point (orthogonal to sin theta and cos theta). The shape is a strict local minimum of the
// energy when the smallest eigenvalue is positive (docs/elastica.md; Sachkov 2008).
#pragma once

#include <optional>

#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

// The smallest eigenvalue of H times length^2: dimensionless, pi^2..4 pi^2 for relaxed blades, 0 where the
// shape is lost. It is found by finite differences on 128 cells, with an error of about 2e-4 of itself and
// at most 1e-6 of the search for it.
[[nodiscard]] double stability_margin(const Elastica& elastica);
// The margin, searched from that of a neighbouring shape, which saves half the work or costs two looks more.
[[nodiscard]] double stability_margin(const Elastica& elastica, double nearby);
[[nodiscard]] double stability_margin(const ElasticaCurve& curve);

// The arc length of the first conjugate point: the longest start of the curve, extended along itself up to
// `furthest`, that is stable between clamps ends there. It is absent when there is none, and exact to 1e-9
// of `furthest`. It comes from the Jacobi fields, which agree with the margin's sign.
[[nodiscard]] std::optional<double> first_conjugate_point(const Elastica& elastica, double furthest);

}  // namespace hotblade::elastica
