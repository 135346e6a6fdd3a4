// Curves as circular arcs of the same length: biarcs and triarcs with length preservation.
//
// A convex spiral (curvature monotone, of one sign) has exactly one biarc with its ends, end tangents and
// length, and both lie in the bilens of its end curvatures, whose width bounds their distance (Kurnosenko
// 2018, theorem 1 and equation 10, after Sabitov and Slovesnov). A curve is split where its curvature has an
// extremum or changes sign, and each spiral into as few pieces as the tolerance allows. Any length unit;
// docs/arcs.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

// A circular arc, or a straight segment where kappa is 0, by its start state.
struct Arc {
  double x = 0, y = 0, theta = 0, kappa = 0, length = 0;
};
[[nodiscard]] CurvePoint point_at(const Arc& arc, double s);

// Both ends of a spiral and its length; theta.b - theta.a is its true turning.
struct SpiralEnds {
  CurvePoint a, b;
  double length = 0;
};

// The family of biarcs between two directed points, p in (0, infinity), in the chord's frame: half chord c,
// end tangents at alpha and beta against the chord (section 1.2 of the paper).
struct BiarcFamily {
  double x = 0, y = 0, direction = 0;  // chord's start and direction
  double c = 0, alpha = 0, beta = 0;
  // The family between two directed points; absent when the ends coincide or an end tangent points more than
  // pi away from the chord, where there is no short biarc.
  [[nodiscard]] static std::optional<BiarcFamily> between(const CurvePoint& a, const CurvePoint& b);
  [[nodiscard]] double omega() const { return 0.5 * (alpha + beta); }
  [[nodiscard]] double gamma() const { return 0.5 * (alpha - beta); }
  // The curvatures of the two arcs, and the length of both together (equations 6 and 8).
  [[nodiscard]] double first_curvature(double p) const;
  [[nodiscard]] double second_curvature(double p) const;
  [[nodiscard]] double length(double p) const;
  [[nodiscard]] std::array<Arc, 2> arcs(double p) const;
};

// The region of every spiral with these ends, tangents and end curvatures (section 1.3): between the biarcs
// of p1 and p2.
struct Bilens {
  double p1 = 0, p2 = 0;
  double width = 0;  // largest circle in it; for convex spirals (equation 10)
};
// The bilens of these ends and end curvatures; absent when no short spiral has them: Q >= 0 (equation 2), up
// to rounding.
[[nodiscard]] std::optional<Bilens> bilens(const BiarcFamily& family, double kappa_a, double kappa_b);

enum class ArcOrder { kBiarc, kTriarc };

// The biarc, or the triarc that has the end curvatures too, with the ends, tangents and length of a convex
// spiral. They are two or three arcs, one for a circular arc; the result is absent when no spiral has these
// ends and this length.
struct SpiralArcs {
  std::vector<Arc> arcs;
  double error_bound = 0;  // no point of the spiral is farther from the arcs, nor the other way
};
[[nodiscard]] std::optional<SpiralArcs> spiral_arcs(const SpiralEnds& ends, ArcOrder order);

// The error bound of spiral_arcs alone; infinite where it has no arcs.
[[nodiscard]] double spiral_bound(const SpiralEnds& ends);

// A whole curve as arcs, each starting at the end of the one before with the same tangent.
struct ArcFit {
  std::vector<Arc> arcs;
  double error_bound = 0;   // largest of the pieces
  double length = 0;        // of the arcs together; the curve's to 1e-12
  std::size_t spirals = 0;  // pieces the curve was split into
};

// Fits an elastica within `tolerance` > 0, from each spiral's start as far as the bound allows. A triarc fit
// of n spirals has 2n + 1 arcs at most: neighbours share the curvature at their joint and are merged. Throws
// std::logic_error for a tolerance that is not positive, a length that is not, or what ElasticaCurve refuses.
[[nodiscard]] ArcFit fit_arcs(const Elastica& elastica, double tolerance, ArcOrder order);

// Fits the cubic spline through sampled points of a curve of bounded curvature, parametrised by the chords.
// There must be at least 4 points, finite and each distinct from its neighbours (std::logic_error). The
// bound is against the spline. Pieces on which the spline is no spiral to rounding are halved until they are
// arcs within the tolerance.
inline constexpr std::size_t kFewestArcPoints = 4;
[[nodiscard]] ArcFit fit_arcs(std::span<const Eigen::Vector2d> points, double tolerance, ArcOrder order);

// Arc lengths 0 = s0 < s1 < ... = length between which the curvature of an elastica is monotone and of one
// sign.
[[nodiscard]] std::vector<double> spiral_breaks(const Elastica& elastica);

}  // namespace hotblade::elastica
