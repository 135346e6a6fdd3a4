// Bounds for the search of equilibria.hpp: an elastica as a swing of the pendulum psi'' = -sin psi.
//
// psi is the tangent's angle against the end force, c = psi'^2/2 - cos psi its energy, T the time from psi0
// to psi1 = psi0 + turning, A = 1/2 Int psi'^2 the action. A blade of length 1 that ends at distance r in
// direction chi, seen from its start clamp, satisfies, with beta = psi0 + chi,
//   psi'(0) - psi'(T) = r T sin beta,   A - c T = r T cos beta,
// and has lambda = T^2 and energy A T. Here the start curvature is positive; mirroring gives the others.
#pragma once

#include <cstdint>
#include <vector>

namespace hotblade::elastica::cells {

struct Interval {
  double lo = 0, hi = 0;
};

// The clamps, as seen from the start of a blade of length 1.
struct Target {
  double r = 0, chi = 0, turning = 0;
};

// psi0 and w = -log(m), m = |c - 1|/2: below the separatrix (c < 1) the curve has inflections or could have,
// above it has none.
struct Cell {
  Interval psi0, w;
  bool above = false;
  std::uint64_t types = 0;  // bit n: n inflections not excluded yet; above: bit 0
};

// The start state of the pendulum's swing from (psi0, w) to psi0 + turning with n turning points.
struct Swing {
  double kappa = 0, lambda1 = 0, lambda2 = 0;
};

// Cells that cover every solution with at most max_inflections: outside them the bounds of the set itself
// exclude one (c >= -r because cos psi >= -c all along) or the blade is taut or a circle to 1e-6.
[[nodiscard]] std::vector<Cell> initial_cells(const Target& target, int max_inflections);

// The types that the cell may hold, by interval arithmetic: a type is dropped only when no point of the cell
// satisfies both conditions within max_energy.
[[nodiscard]] std::uint64_t possible_types(const Cell& cell, const Target& target, double max_energy);

// The start state at a place of a cell, its middle or a corner, moved into the domain where it lies outside.
[[nodiscard]] Swing swing_at(double psi0, double w, bool above, int n, const Target& target);

// An upper bound of the inflections of a shape with this energy: each swing between two inflections has
// action and time of at least those at c = -r.
[[nodiscard]] int inflection_bound(const Target& target, double max_energy);

// The number of solutions nearer to the separatrix than the cells go, found by sign changes over a fine scan
// of psi0. There the blade lies along its tension but for bends whose action no longer depends on c, and T
// is free: it follows from the distance of the clamps, and the direction of the chord is the one condition
// left.
[[nodiscard]] int taut_solutions(const Target& target, int max_inflections, double max_energy);

}  // namespace hotblade::elastica::cells
