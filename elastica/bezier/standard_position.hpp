// A cubic Bezier in the standard position of the projections: ends at (0, 0) and (1, 0), so that only the end
// edges' directions and lengths are left (Brander, Bærentzen, Fisker, Gravesen 2018, section 5;
// docs/elastica.md).
#pragma once

#include <numbers>
#include <optional>

#include "elastica/bezier/bezier.hpp"

namespace hotblade::elastica {

// End edges of lengths l1, l2 (chords) in directions a1 (p0 to p1) and a2 (p3 to p2, not the end tangent), in
// (-pi, pi].
struct StandardPosition {
  double a1 = 0, a2 = 0, l1 = 0, l2 = 0;
};

// The standard position of a Bezier; absent when the end points coincide or an end edge is zero.
[[nodiscard]] std::optional<StandardPosition> standard_position(const Bezier& bezier);

// The Bezier in standard position, with its ends at (0, 0) and (1, 0).
[[nodiscard]] Bezier to_bezier(const StandardPosition& s);

// The Bezier whose inner control points are moved along its end tangents to the edge lengths of `s`; `input`
// is the position it stands at.
[[nodiscard]] Bezier with_edges(const Bezier& bezier, const StandardPosition& input,
                                const StandardPosition& s);

// Whether the polygon's inner angles lie on different sides of pi, so that the curve has an inflection.
[[nodiscard]] bool inflectional(const StandardPosition& s);

// Distances from the ends at which the lines of the first and third edge meet, in chords; absent when they
// are parallel.
[[nodiscard]] std::optional<std::array<double, 2>> edge_meeting(const StandardPosition& s);

// Whether the first and the third edge of the polygon cross or touch.
[[nodiscard]] bool edges_cross(const StandardPosition& s);

// The position with both end edges shortened to just before their crossing, where they cross; else the same.
[[nodiscard]] StandardPosition uncrossed(StandardPosition s);

// The paper's angle constraints: (1) beta1 = pi - a1 and beta2 = a2, taken in [0, 2 pi), lie more than
// `from_chord` from 0 and 2 pi; (2) they differ by less than `difference`. Its wider pairs are pi/4 with 0.6
// pi and pi/6 with 0.75 pi.
struct AngleConstraints {
  double from_chord = std::numbers::pi / 3, difference = 0.4 * std::numbers::pi;
};
[[nodiscard]] bool angle_constraints_hold(const StandardPosition& s,
                                          const AngleConstraints& constraints = {});

// The lambda-residual of the curve; 1 for a cusp.
[[nodiscard]] double score(const StandardPosition& s);

// The same angle in (-pi, pi].
[[nodiscard]] double wrapped(double angle);

}  // namespace hotblade::elastica
