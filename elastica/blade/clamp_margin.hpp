// How far a blade's clamps may err before its shape is lost: the distance of its clamps to the nearest fold.
//
// Errors of both clamps count together: the square root of the sum of their squares, a turn of a clamp
// counted by mm_per_rad. The size of an error does not depend on where the pair of clamps stands, so the
// margin of one blade changes by no more than its clamps move against each other (clamp_distance): margins at
// some poses of a continuous motion bound it at all others from below.
//
// A fold is a shape whose second variation has a zero eigenvalue: there the blade snaps to another shape.
// Folds of both sides meet where the blade is pulled straight with its tangents along it: from there it may
// bow to either side, so that pose counts as well. A blade pulled taut in other ways keeps its side and is
// not lost. Units: mm, rad.
#pragma once

#include <span>
#include <vector>

#include "elastica/blade/continuation.hpp"
#include "elastica/blade/taut.hpp"

namespace hotblade::elastica {

struct ClampMarginOptions {
  // Folds farther away are not looked for.
  double largest_mm = 50;
  // A turn of one rad counts as this many mm; 0 takes half the blade's length, the largest move that a turn
  // about its middle gives.
  double mm_per_rad = 0;
  // Whether folds are looked for everywhere though those of a neighbouring pose lead to some.
  bool everywhere = false;
};

// A shape about to be lost, and the clamps' error that leads to it.
struct Fold {
  double distance_mm = 0;
  Elastica shape;  // between the erring clamps
};

struct ClampMargin {
  // The smaller of the two below; largest_mm when neither is nearer.
  double margin_mm = 0;
  double straight_mm = 0;  // to the straight blade between aligned clamps
  // To the nearest fold found; largest_mm when there is none nearer than the straight blade.
  double fold_mm = 0;
  // Local minima of the distance to folds, the nearest first; they lead to those of a neighbouring pose.
  std::vector<Fold> folds;
};

// The margin of a shape. The search starts from a table of folds (fold_table.hpp) and along the edges in
// which they meet, and goes down the surface of folds by Newton's method; the straight way to each fold is
// followed, so that the shape is known to hold up to it. The nearest of the minima found is an upper bound of
// the distance; tests/elastica/blade/clamp_margin_test.cpp compares with dense searches. All distances are 0
// for a shape that is not stable, and one pulled taut has no folds. Throws std::logic_error when largest_mm
// is not positive, mm_per_rad is negative or the shape is not finite.
[[nodiscard]] ClampMargin clamp_margin(const Elastica& elastica, const ClampMarginOptions& options = {});

// The margin, searched from the folds of neighbouring poses of the same blade with a part of the work;
// everywhere as well when nothing leads to a fold of this pose so, or that is asked for.
[[nodiscard]] ClampMargin clamp_margin(const Elastica& elastica, std::span<const Fold> near,
                                       const ClampMarginOptions& options = {});

// The size of the least errors of both clamps that lead from `a` to `b`, wherever in the plane either pair
// stands. Newton's method finds the turn between them; the result is never too small.
[[nodiscard]] double clamp_distance(const ClampPair& a, const ClampPair& b, double mm_per_rad);

}  // namespace hotblade::elastica
