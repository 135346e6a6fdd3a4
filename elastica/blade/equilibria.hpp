// Every shape that a blade of given length can take between two given clamps.
//
// An elastica is a swing of a pendulum, so a shape is told by two numbers - the direction of the end force
// and the pendulum's energy - and by how often it swings back, which is the number of its inflections. For
// each number of inflections the two range over a compact set, and the clamps put two conditions on them. The
// set is divided into cells, those where interval bounds exclude a solution are dropped, and Newton's method
// in (kappa, lambda1, lambda2)
// - one smooth chart of all equilibria (Bretl, McCarthy 2014) - is started in those that are left.
// docs/elastica.md says what this proves and what it does not.
#pragma once

#include <limits>
#include <vector>

#include "elastica/blade/continuation.hpp"

namespace hotblade::elastica {

struct Equilibrium {
  Elastica elastica;
  double energy = 0;  // 1/2 Int kappa^2 ds
  bool stable = false;
  double margin = 0;    // stability_margin()
  int inflections = 0;  // strictly inside
};

struct EquilibriaOptions {
  // Limits of the shapes that are looked for; both hold. Three inflections inside or more are never stable
  // (Sachkov 2008), so the default finds every stable shape.
  int max_inflections = 2;
  double max_energy = std::numeric_limits<double>::infinity();
};

struct EquilibriaReport {
  std::vector<Equilibrium> equilibria;  // lowest energy first
  // The number of cells that could neither be excluded nor be resolved; 0 unless the clamps are about to
  // lose a shape.
  int unresolved = 0;
  // The number of cells and shapes left out where the blade is pulled taut beyond what a start state can
  // carry (continuation.hpp).
  int taut = 0;
  int cells = 0;
};

// The most inflections that can be asked for.
inline constexpr int kMaxInflections = 60;

// The shapes of a blade of this length between the clamps. Throws std::logic_error when a number is not
// finite, the length is not positive, or max_inflections is outside [0, kMaxInflections].
[[nodiscard]] EquilibriaReport find_equilibria(const ClampPair& clamps, double length,
                                               const EquilibriaOptions& options = {});

// The number of sign changes of the curvature strictly inside the curve.
[[nodiscard]] int count_inflections(const Elastica& elastica);

}  // namespace hotblade::elastica
