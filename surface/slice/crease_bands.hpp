// Folds that narrow bands of a mesh share out: chamfers, fillets, and teeth of cells that a fold crosses.
#pragma once

#include "surface/slice/creases.hpp"

namespace hotblade::surface {

// Returns the triangles of such bands, ascending, and the edges, in any order, where both sides of their
// folds meet without one.
[[nodiscard]] Creases crease_bands(const TriangleMesh& mesh, const CreaseLimits& limits);

}  // namespace hotblade::surface
