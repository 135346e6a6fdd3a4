// The local half of the optimal projection: from given edge lengths down to the nearest minimum of the
// lambda-residual, many curves at once.
//
// Works on u = ln L1, v = ln L2. The lines of the first and third edge meet at distances m1, m2 from the ends
// (edge_meeting). A curve turns from plain to inflectional exactly where L1 = m1 or L2 = m2, and its edges
// cross exactly where both are longer, so every branch is a union of boxes in (u, v).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "elastica/projection/project.hpp"

namespace hotblade::elastica {

struct EdgeBox {
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
};

// The box of all edge lengths between kShortestEdge and kLongestEdge.
[[nodiscard]] EdgeBox edge_domain();

// The box of the branch (not kBest) that is nearest to (u, v); absent when the branch has none.
[[nodiscard]] std::optional<EdgeBox> branch_box(double a1, double a2, WantedBranch branch, double u,
                                                double v);

// Logarithms of m1, m2 where both exist: the edges cross beyond them.
struct CrossingCorner {
  double u, v;
};
[[nodiscard]] std::optional<CrossingCorner> crossing_corner(double a1, double a2);

// One descent: starts at (u, v), which is moved into the box first, and ends at the minimum.
struct Descent {
  double a1 = 0, a2 = 0;
  EdgeBox box;
  double u = 0, v = 0;
  double huu = 0, huv = 0, hvv = 0;  // second derivatives of e2 by u and v, when known; otherwise zero
  double e2 = 0;                     // square of the lambda-residual there; above 1 for a cusp
};

// Takes Newton steps within box and trust region, with Hessians from differences of exact gradients where
// none is given, until the model promises to lower the residual by less than `share` of it or by less than
// `least`. Results do not depend on which descents are made together.
struct DescentEnd {
  double share, least;
};
void descend(std::span<Descent> descents, const DescentEnd& end);

// The squares of the lambda-residual at many places; above 1 for a cusp or crossing edges.
[[nodiscard]] std::vector<double> squared_residuals(double a1, double a2, std::span<const double> u,
                                                    std::span<const double> v);

}  // namespace hotblade::elastica
