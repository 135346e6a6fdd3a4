// What the study of circular arcs measures with: distances to arcs, biarcs by bisection, random spirals.
#pragma once

#include <span>
#include <vector>

#include "elastica/arcs/arcs.hpp"
#include "pipeline/study/random_curves.hpp"

namespace hotblade::pipeline::study {

// The distance of a point to an arc, to rounding for every curvature.
[[nodiscard]] double distance_to(const elastica::Arc& arc, const Eigen::Vector2d& point);

// The largest distance to the arcs of points of the curve, taken evenly by arc length from s = from on.
// Curve and arcs run side by side: a point is compared with the arcs around its arc length only.
[[nodiscard]] double deviation(const elastica::ElasticaCurve& curve, double from,
                               std::span<const elastica::Arc> arcs, int points);

// A curve of known length and curvature, in mm: 200 to 1400 long, curvature up to 1/125 at its start.
[[nodiscard]] elastica::Elastica random_elastica(std::uint64_t seed, std::uint64_t index);

// Biarcs of spirals that are halved until the measured deviation is within the tolerance.
enum class Joint {
  kEqualChords,  // the classical choice: p = 1, whatever the length
  kSameLength    // the biarc of the spiral's length
};
struct BisectedArcs {
  std::size_t arcs = 0;
  double length = 0;
};
[[nodiscard]] BisectedArcs bisected_arcs(const elastica::ElasticaCurve& curve, std::span<const double> breaks,
                                         double tolerance, Joint joint);

// Arcs joined smoothly from the origin along the x-axis, 4 to 10 of them, lengths adding up to l, curvatures
// from k1 to k2 in random steps, both included.
[[nodiscard]] std::vector<elastica::Arc> random_spiral(CurveRandom& random, double k1, double k2, double l);

}  // namespace hotblade::pipeline::study
