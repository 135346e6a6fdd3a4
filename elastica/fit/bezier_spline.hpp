// Cubic Beziers for those who do not speak elastica: as few as come within a distance of one.
#pragma once

#include <vector>

#include "elastica/bezier/bezier.hpp"
#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

inline constexpr int kMostSplinePieces = 64;

// Returns cubics over equal lengths of the elastica, joined with their first derivatives: points and tangents
// at the joints are the elastica's, a derivative is the piece's length. The fewest, doubled from one, whose
// Hausdorff distances to their parts are at most `distance` > 0 (std::logic_error); kMostSplinePieces where
// more were needed. A cubic that interpolates so is off by the fourth power of its length.
[[nodiscard]] std::vector<Bezier> bezier_spline(const Elastica& elastica, double distance);

}  // namespace hotblade::elastica
