// Quadratic Beziers of least length or bending energy between two points, tangent to a line or a circle.
//
// The curve touches the line or circle once, from one side. The middle control point then lies on a locus of
// one or more components (Ahn, Hoffmann, Rosen 2014, section 4; maths in docs/arcs.md): every local minimum
// on each is found, and the lowest is marked. Any length unit.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "elastica/quadratic/quadratic.hpp"

namespace hotblade::elastica {

enum class Objective { kLength, kEnergy };

// The part of the locus on which a minimum lies. kCloser: the ends and the circle's centre are on opposite
// sides of the common tangent; kFarther: on the same side, so that the curve bends around the circle;
// kEndTangent0, kEndTangent2: the contact is the end point itself, which is on the line or circle, and b1 is
// on its tangent there; kChord: the straight segment is tangent.
enum class TangencyBranch { kLine, kCloser, kFarther, kEndTangent0, kEndTangent2, kChord };

struct TangentMinimum {
  Quadratic curve;
  Eigen::Vector2d contact{0, 0};
  double contact_t = 0;  // in [0, 1]
  double value = 0;      // length or energy
  TangencyBranch branch = TangencyBranch::kLine;
  // False where the curve has no tangent at the contact: a fold that touches with its tip, or an end edge of
  // length zero. This happens with lengths only; such a curve is the limit of tangent ones.
  bool regular = true;
};

enum class TangentStatus { kOk, kInfeasible };

// The places of the ends: 2 outside, one outside and one inside, one outside and one on, 2 inside, one on
// and one inside, 2 on the circle (the paper's figure 6, a to f).
enum class CircleCase { kOutsideOutside, kOutsideInside, kOutsideOn, kInsideInside, kOnInside, kOnOn };

struct TangentCurves {
  TangentStatus status = TangentStatus::kInfeasible;  // infeasible: no such curve has a least value
  std::vector<TangentMinimum> minima;                 // all local minima, lowest value first
  std::size_t best = 0;  // the lowest regular one, or the lowest where none is regular; 0 when there is none
  CircleCase circle_case = CircleCase::kOutsideOutside;  // of tangent_to_circle
};

// The curves that are tangent to a line, or to a circle. The line runs through `on` and `on + direction`;
// the problem is infeasible when the ends lie on different sides of it. The ends may not coincide, the
// direction may not be zero, the radius must be positive, everything finite (std::logic_error). An end
// nearer to the line or circle than 1e-13 of the problem's size counts as on it.
[[nodiscard]] TangentCurves tangent_to_line(const Eigen::Vector2d& b0, const Eigen::Vector2d& b2,
                                            const Eigen::Vector2d& on, const Eigen::Vector2d& direction,
                                            Objective objective);
[[nodiscard]] TangentCurves tangent_to_circle(const Eigen::Vector2d& b0, const Eigen::Vector2d& b2,
                                              const Eigen::Vector2d& centre, double radius,
                                              Objective objective);

}  // namespace hotblade::elastica
