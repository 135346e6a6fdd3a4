// A curve given by its points, tangents and curvatures, split into spirals that are fitted by arcs within a
// tolerance.
#pragma once

#include <functional>
#include <vector>

#include "elastica/arcs/arcs.hpp"

namespace hotblade::elastica {

// The arcs of `curve`, which gives its points by arc length with a continuous theta. `breaks` are increasing
// arc lengths, the first and the last its ends; between them the curvature is monotone and of one sign, as
// far as rounding tells. Throws std::runtime_error when pieces as short as rounding still are no arcs.
[[nodiscard]] ArcFit fit_arcs_between(const std::function<CurvePoint(double)>& curve,
                                      const std::vector<double>& breaks, double tolerance, ArcOrder order);

}  // namespace hotblade::elastica
