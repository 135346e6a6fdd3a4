// Creases of a design, as folded plates, hipped roofs and crossing vaults have them.
#pragma once

#include <vector>

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {

// What is a crease.
struct CreaseLimits {
  // What a cut may be off by. A mesh stands for a smooth surface where its chords are within some of these.
  double tolerance_mm = 1;
  // The smallest radius that a cut can have: it rounds a fold of less within the tolerance.
  double least_radius_mm = 100;
  // Folds that such a radius rounds are creases too where they stand alone, and chamfers and fillets however
  // far from their sides, led on to their corners.
  bool shallow = false;
};

// Where a design is creased: edges, by their lower corners, ascending, and triangles that belong to a fold
// and to neither of its sides, ascending.
struct Creases {
  std::vector<int> edges, bands;

  [[nodiscard]] bool empty() const { return edges.empty() && bands.empty(); }
};

// Returns the creases. An edge is one where both faces keep their directions for so far to its sides that a
// smooth surface through them would be off by more than four tolerances, and no rounding by the least radius
// stays within one; or, with `shallow`, it stands alone: no edge within 400 mm to its sides folds by a
// quarter of it. A fold that goes on at the next edges, as a coarse arc's, is none, but for bands of 8 mm at
// most within the tolerance of their sides, led on to their corner: chamfers, fillets, and the teeth of a
// mesh whose cells a fold crosses. Throws std::logic_error where a limit is not above 0.
[[nodiscard]] Creases creases(const TriangleMesh& mesh, const CreaseLimits& limits);

}  // namespace hotblade::surface
