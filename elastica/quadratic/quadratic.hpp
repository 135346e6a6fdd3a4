// Quadratic Bezier curves: length and bending energy in closed form, their level sets in the middle control
// point, the parabola behind the curve, arc-length inverse and nearest point.
//
// The formulas are elastica/kernels/quadratic.h, shared with devices; here they take and give vectors. Any
// length unit, energy 1/length. Sources: Ahn, Hoffmann, Rosen, "Geometric constraints on quadratic Bezier
// curves using minimal length and energy" (2014, equations 3 and 4); docs/arcs.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace hotblade::elastica {

using Quadratic = std::array<Eigen::Vector2d, 3>;

// The point at t; t may lie outside [0, 1].
[[nodiscard]] Eigen::Vector2d point_at(const Quadratic& curve, double t);

// The arc length of the whole curve, and of its part from t = 0 to t in [0, 1]; the relative error is about
// 1e-15, for folded and straight curves too.
[[nodiscard]] double length(const Quadratic& curve);
[[nodiscard]] double length_to(const Quadratic& curve, double t);

// The parameter in [0, 1] at arc length s, clamped to the ends: length_to of it is s to rounding.
[[nodiscard]] double parameter_at(const Quadratic& curve, double s);

// The bending energy 1/2 Int kappa^2 ds, with a relative error of about 1e-14 for every triangle; 0 where
// the control points lie in order on a line, infinite where the curve folds back on itself.
[[nodiscard]] double energy(const Quadratic& curve);

enum class ParabolaStatus {
  kOk,
  kFolded,  // the control points lie on a line, unevenly
  kLine     // b1 is the ends' midpoint
};

// The curve is the image of y = x^2, x from x0 (t = 0) to x1 (t = 1), under
//   p = origin + scale (x X + y Y),  Y = axis, X = Y turned by -90 degrees.
// When the curve is folded, origin is the turning point (it may lie beyond the ends), the curve is the two
// segments to it, and scale, x0 and x1 are 0. When it is a line, only origin is set, to b0.
struct Parabola {
  Eigen::Vector2d origin{0, 0}, axis{0, 0};
  double scale = 0, x0 = 0, x1 = 0;
  ParabolaStatus status = ParabolaStatus::kOk;
};
[[nodiscard]] Parabola parabola(const Quadratic& curve);

// The nearest point on the curve, the first one of equals.
struct QuadraticNearest {
  double t = 0;
  Eigen::Vector2d point{0, 0};
  double distance = 0;
};
[[nodiscard]] QuadraticNearest nearest(const Quadratic& curve, const Eigen::Vector2d& query);

// The places of the middle control point at which the curve from b0 to b2 has a given length or energy: n >=
// 3 points about the midpoint of b0 b2, anticlockwise from the direction of b2, at equal steps of the
// eccentric angle for the length (whose level sets are convex and near to ellipses) and of the direction for
// the energy. On the chord's line the energy's level set passes through the end points. The list is empty
// when there is none (a length below the chord's, an energy of 0). Throws std::logic_error for coinciding
// ends, a value that is not finite, or n < 3.
[[nodiscard]] std::vector<Eigen::Vector2d> length_level_set(const Eigen::Vector2d& b0,
                                                            const Eigen::Vector2d& b2, double length, int n);
[[nodiscard]] std::vector<Eigen::Vector2d> energy_level_set(const Eigen::Vector2d& b0,
                                                            const Eigen::Vector2d& b2, double energy, int n);

}  // namespace hotblade::elastica
