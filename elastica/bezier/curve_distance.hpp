// Distances between a cubic Bezier and an elastica: the paper's L2 and H1 (Brander, Bærentzen, Fisker,
// Gravesen, "Bezier curves that are close to elastica", section 2) and the Hausdorff distance with a proven
// bound on its sampling error (docs/elastica.md).
#pragma once

#include "elastica/bezier/bezier.hpp"
#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

// Bounds of a distance, which lies between them up to rounding; unit of the input.
struct HausdorffBounds {
  double lower = 0, upper = 0;
};

// Bounds of the Hausdorff distance, both ways. They are refined until upper - lower <= tolerance, which must
// be above 0 (std::logic_error), or until 20,000 samples are used up: then they hold as well, only wider
// apart.
[[nodiscard]] HausdorffBounds hausdorff(const Bezier& bezier, const Elastica& elastica, double tolerance);

// The distances of a Bezier to an elastica that is traversed proportionally to the Bezier's arc length.
struct CurveDistance {
  double l2 = 0, h1 = 0;       // pure numbers, relative to the Bezier's length
  double hausdorff = 0;        // upper bound, unit of the input
  double hausdorff_error = 0;  // by how much the bound may be too large: 1e-6 of the Bezier's length or less
};
[[nodiscard]] CurveDistance distance(const Bezier& bezier, const Elastica& elastica);

}  // namespace hotblade::elastica
