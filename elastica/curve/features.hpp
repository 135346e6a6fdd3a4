// Features of an elastica segment by closed form: inflections, vertices, self-intersections; splitting and
// similarity.
//
// With kappa = 2 k w cn(v) (inflectional), 2 w sech(v) or 2 r dn(v) (winding), v = rate s + phase
// (elastica/curve/closed_form.hpp), inflections lie at v = (2j + 1) K, vertices (kappa' = 0) at v = 2jK, or
// at jK when winding. The curve is symmetric about every vertex, and points of equal curvature are equally
// far along its normal, so it meets itself only in pairs (c - d, c + d) about a vertex c, at the roots d of
// one function whose turning points are known. segment() and reversed() of elastica/curve/elastica.hpp
// extend and reverse it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "elastica/curve/elastica.hpp"

namespace hotblade::elastica {

// The arc lengths in [0, length] at which the curvature is zero, ascending; a feature within rounding of an
// end counts. A straight line has none. All functions here throw std::logic_error for what is not a curve,
// and where more than kMaxFeatures would have to be returned.
[[nodiscard]] std::vector<double> inflections(const Elastica& elastica);

// The arc lengths in [0, length] at which the curvature has an extremum, ascending. Lines and circles have
// none.
[[nodiscard]] std::vector<double> vertices(const Elastica& elastica);

// The arc length after which the curvature repeats; absent for lines, circles and the separatrix. For a
// segment too short to show its shape it is only as good as its state's digits.
[[nodiscard]] std::optional<double> curvature_period(const Elastica& elastica);

// Two arc lengths of one point where the curve crosses itself.
struct Crossing {
  double first = 0, second = 0;  // first < second
};

// All crossings within the segment, by their middle and then their distance; touching without crossing, and a
// curve that runs along itself (closed ones, circles), do not count.
[[nodiscard]] std::vector<Crossing> self_intersections(const Elastica& elastica);

// The pieces between the given arc lengths, which must ascend within (0, length) (std::logic_error).
[[nodiscard]] std::vector<Elastica> split(const Elastica& elastica, std::span<const double> at);

// A similarity of the plane, p -> scale * R(rotation) * M p + (dx, dy), where M mirrors y when asked; scale
// is above 0.
struct Similarity {
  double scale = 1, rotation = 0;
  bool mirrored = false;
  double dx = 0, dy = 0;
};
// The image of the curve under the map, forces included.
[[nodiscard]] Elastica transformed(const Elastica& elastica, const Similarity& map);

// More features than these are not listed: a curve with so many winds too often to be worked with.
inline constexpr std::size_t kMaxFeatures = 1'000'000;

}  // namespace hotblade::elastica
