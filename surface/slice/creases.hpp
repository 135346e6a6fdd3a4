// Creases of a design, as folded plates, hipped roofs and crossing vaults have them.
#pragma once

#include <vector>

#include "surface/read/triangle_mesh.hpp"

namespace hotblade::surface {

// When an edge is a crease.
struct CreaseLimits {
  // What a cut may be off by. A mesh stands for a smooth surface where its chords are within some of these.
  double tolerance_mm = 1;
  // The smallest radius that a cut can have: it rounds a fold of less within the tolerance.
  double least_radius_mm = 100;
  // Folds that such a radius rounds are creases too where they stand alone, and chamfers and fillets however
  // far from their sides, led on to their corners.
  bool shallow = false;
};

// An edge that is a crease, by its lower corner, and how wide its fold is, square to it, and how much of that
// lies beyond the edge as seen from the corner's triangle; 0: it is at the edge alone.
struct Crease {
  int corner = 0;
  double band_mm = 0, beyond_mm = 0;
};

// Returns the edges that are creases, by corners, ascending: both faces keep their directions for so far to
// its sides that a smooth surface through them would be off by more than four tolerances, and no rounding by
// the least radius stays within one; or, with `shallow`, it stands alone: no edge within 400 mm to its sides
// folds by a quarter of it. A fold that goes on at the next edges, as a coarse arc's, is none, but for a
// chamfer or a fillet of 8 mm at most that is within the tolerance of its sides, led on to their corner: of
// its edges those in the middle are. Throws std::logic_error where a limit is not above 0.
[[nodiscard]] std::vector<Crease> creases(const TriangleMesh& mesh, const CreaseLimits& limits);

// Returns creases with all other edges of their chamfers and fillets, by corners, ascending.
[[nodiscard]] std::vector<Crease> with_bands(const TriangleMesh& mesh, const std::vector<Crease>& creases);

}  // namespace hotblade::surface
