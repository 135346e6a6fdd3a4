// An elastica as a chain of quadratic Beziers, for distances in bulk (gpu/curve/curve_distance.hpp): as few
// as keep it within a tolerance, short where it bends and where its bend changes.
#pragma once

#include <vector>

#include "elastica/curve/elastica.hpp"
#include "elastica/quadratic/quadratic.hpp"

namespace hotblade::elastica {

struct QuadraticChain {
  std::vector<Quadratic> pieces;   // end to end, tangents common at the joints to rounding
  std::vector<double> arc_length;  // of the elastica at the joints; pieces + 1 values from 0 to its length
  // No point of the chain is farther from the elastica than this, nor the other way round, up to rounding
  // (1e-13 of the size); so no distance to the one differs by more from the distance to the other.
  double bound = 0;
};

// The chain of an elastica within a tolerance. Each piece touches the elastica at both ends. Its bound: with
// s a cubic in u that has the right speed at both ends, D(u) = Q(u) - E(s(u)) is sampled, and between
// samples h apart it exceeds their largest by at most h^2/8 max |D''|, where |D''| is sampled too and |D'''|
// bounded by |kappa| and |lambda|. The error falls with the fourth power of a piece's length, with the third
// next to an inflection. Throws std::logic_error for what is not a curve, or unless tolerance > 0; a
// tolerance below 1e-12 of the length is raised to that.
[[nodiscard]] QuadraticChain quadratic_chain(const Elastica& elastica, double tolerance);

}  // namespace hotblade::elastica
