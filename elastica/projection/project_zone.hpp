// The projection zone PI: cubics known by the angles and edges of their polygon to be close to elastica, with
// a lambda-residual below 0.4, and the projection into it (Brander, Bærentzen, Fisker, Gravesen 2018, section
// 5).
#pragma once

#include <vector>

#include "elastica/bezier/standard_position.hpp"
#include "elastica/projection/project.hpp"

namespace hotblade::elastica {

// Inner angles of the polygon in [0, 2 pi): phi1 counter-clockwise from (p0 - p1) to (p2 - p1), phi2 from
// (p1 - p2) to (p3 - p2).
struct PolygonAngles {
  double phi1 = 0, phi2 = 0;
};
[[nodiscard]] PolygonAngles polygon_angles(const StandardPosition& s);

// The limits of edge-length constraint 1: both end edges lie between `shortest` and `longest` chords.
struct EdgeLimits {
  double shortest = 0, longest = 0;
};
[[nodiscard]] EdgeLimits edge_limits(double a1, double a2);

// Whether edge-length constraint 1 holds and, for inflectional curves, 2: neither edge is over 1.3 times the
// other.
[[nodiscard]] bool edge_lengths_hold(const StandardPosition& s);

// Whether the angles lie inside the periodic cubic spline through the paper's 16 points (chord-length
// parameters).
[[nodiscard]] bool inside_zone_boundary(const PolygonAngles& angles);

// Whether the curve lies in the zone: angle constraints and edge lengths hold, edges do not cross, angles
// are inside the boundary.
[[nodiscard]] bool in_projection_zone(const StandardPosition& s);

// The boundary as a closed polyline in the (phi1, phi2) plane, 16 n + 1 points.
[[nodiscard]] std::vector<PolygonAngles> zone_boundary(int n);

// The paper's projection into the zone: crossing edges shortened, edge lengths brought within their
// constraints, then deformation (1) for inflectional and (2) for plain curves up to the boundary. A curve
// that is in the zone comes back unchanged. `status` says whether the lambda-residual is at or below
// `threshold`. Without the angle constraints the deformation may end outside the zone; with them it does for
// about one curve in 2000, whose shortest and longest edges stop just short (differs from the paper, which
// has none).
[[nodiscard]] Projection project_zone(const Bezier& bezier, double threshold = kZoneResidual);

}  // namespace hotblade::elastica
