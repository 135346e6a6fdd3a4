// The global half of the optimal projection: where the minima of the lambda-residual lie. They depend on the
// two end directions alone, so a table over both, made when the program is built (generate_valleys.cpp),
// gives starts for the descents of project_polish.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "elastica/projection/project.hpp"
#include "elastica/projection/project_polish.hpp"

namespace hotblade::elastica {

// The minimum over one cell of the table as quadratics in the distance (x, y) from the cell's middle to the
// end directions asked for: ln L = c[0] + c[1] x + c[2] y + c[3] x x + c[4] x y + c[5] y y.
struct Valley {
  float u[6], v[6];
  float huu, huv, hvv;   // second derivatives of e2 by u and v at the minimum; all zero: unknown
  float x0, x1, y0, y1;  // the part of the cell in which it is needed, rad from the middle
};

// Cells lie around a = -pi + (i + 1/2) 2 pi / kValleyNodes in either direction; half a step keeps the middles
// off the directions along the chord, and every symmetry of the problem maps cells to cells.
inline constexpr int kValleyNodes = 64;

struct ValleysNear {
  std::span<const Valley> valleys;
  double x = 0, y = 0;  // from the cell's middle to the place asked for, rad
};

// The valleys one of which holds the least residual of the branch, a1 and a2 in (-pi, pi]. There are none
// where the branch has no curve in the domain anywhere near.
[[nodiscard]] ValleysNear valleys_near(double a1, double a2, WantedBranch wanted);

// ln L of a valley's quadratic.
[[nodiscard]] inline double valley_edge(const float (&c)[6], double x, double y) {
  return c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y;
}

// The descent from a valley at (x, y) from its cell's middle; absent where the branch has no curve. Made with
// kValleyEnd, as the table's cells were covered: the last step is left undone when it would lower e by less
// than a thousandth, or by 1e-5.
inline constexpr DescentEnd kValleyEnd{1e-3, 1e-5};
[[nodiscard]] inline std::optional<Descent> valley_descent(double a1, double a2, WantedBranch wanted,
                                                           const Valley& valley, double x, double y) {
  const double u = valley_edge(valley.u, x, y), v = valley_edge(valley.v, x, y);
  const auto box = wanted == WantedBranch::kBest ? edge_domain() : branch_box(a1, a2, wanted, u, v);
  if (!box) return std::nullopt;
  return Descent{a1, a2, *box, u, v, valley.huu, valley.huv, valley.hvv};
}

}  // namespace hotblade::elastica
