// How long a convex spiral can be, and where it can end: Kurnosenko 2018, inequalities (15) and
// sections 4.1, 4.2.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "elastica/arcs/arcs.hpp"

namespace hotblade::elastica {

struct LengthRange {
  double least = 0, greatest = 0;
};

// The lengths of all convex spirals between two directed points: the least is a circular arc's and not
// reached, the greatest is the biarc's with a straight part. The range is absent unless the end tangents are
// on one side of the chord (alpha beta < 0).
[[nodiscard]] std::optional<LengthRange> convex_length_range(const BiarcFamily& family);

// The lengths of those that have these end curvatures too: they lie between the two biarcs of the bilens;
// absent where there is no bilens.
[[nodiscard]] std::optional<LengthRange> convex_length_range(const BiarcFamily& family, double kappa_a,
                                                             double kappa_b);

// The region in which a convex spiral of length l > 0 can end that starts at the origin along the x-axis and
// whose curvature runs monotonically within k1 to k2. Returns its boundary as a closed polygon of 2 n points
// on Gamma1 (one arc of curvature k1 to k2) and back on Gamma2 (two arcs of curvatures k1 and k2). |k1|,
// |k2| at most pi/l: the turning may not exceed pi, or the boundary crosses itself (std::logic_error). n is
// at least 2.
[[nodiscard]] std::vector<Eigen::Vector2d> spiral_reach(double k1, double k2, double l, int n);

// The part of that region for a given turning, which lies between k1 l and k2 l (std::logic_error): its
// boundary runs from the circular arc, on the boundary with the last curvature k2, to the biarc of k1 and
// k2, and back on the boundary with the first curvature k1.
[[nodiscard]] std::vector<Eigen::Vector2d> spiral_reach(double k1, double k2, double l, double turning,
                                                        int n);

// Whether the end point lies in the region: quick, to sort out clamp positions before an equilibrium is
// sought. The polygon has 256 points a side and is widened by what they can miss, so that no reachable point
// is refused.
[[nodiscard]] bool spiral_reaches(double k1, double k2, double l, const Eigen::Vector2d& end);

// An oval of four spirals: lengths l and vertex curvatures k, k[0] < k[1] > k[2] < k[3] > k[0], all positive
// (section 4.2).
struct Oval {
  double l[4], k[4];
};

// Points that bound where the half V0 V1 V2 of an oval that turns by mu can end (half 0), and the half V0 V3
// V2 run backwards (half 1), both starting at the origin, downwards and upwards: of the bound AB, whose two
// spirals are single arcs, and of the bound CD, three arcs of the curvatures at its vertices. u and v are
// the paper's; the point is absent outside their ranges.
[[nodiscard]] std::optional<Eigen::Vector2d> oval_bound_ab(const Oval& oval, int half, double mu, double u);
[[nodiscard]] std::optional<Eigen::Vector2d> oval_bound_cd(const Oval& oval, int half, double mu, double v);

// The turnings mu at which the bound AB of one half touches the bound CD of the other, ascending: between
// two of them the oval can close. The list is empty when there is no such contact, as far as a grid of
// starts for Newton's method tells.
struct OvalContact {
  double mu = 0, u = 0, v = 0;
  int ab_half = 0;  // the half whose bound AB touches
};
[[nodiscard]] std::vector<OvalContact> oval_contacts(const Oval& oval);

}  // namespace hotblade::elastica
