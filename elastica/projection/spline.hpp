// Chains of cubics near elastica: every segment projected while the joints stay put and tangent, and a curve
// split where one elastica cannot serve it. Any length unit.
#pragma once

#include <span>
#include <vector>

#include "elastica/bezier/bezier.hpp"
#include "elastica/curve/elastica.hpp"
#include "elastica/projection/project.hpp"

namespace hotblade::elastica {

enum class Continuity {
  kG1,  // one tangent direction at a joint: each segment has its own optimum
  kC1,  // one derivative as well: both edges at a joint have one length
};

struct SplineProjection {
  std::vector<Bezier> chain;
  std::vector<double> residuals;  // lambda-residual of each segment
  // kUnsupported, with the chain unchanged: a segment has no chord or a zero end edge, or no common length
  // at a joint lies in both segments' domain (project_optimal's) without crossing edges.
  ProjectStatus status = ProjectStatus::kReached;
};

// The chain with the least residuals: of each segment (kG1, project_optimal), or the least sum of their
// squares over one edge length per joint and end (kC1, dynamic programming on ever finer grids of lengths).
// Joints must meet to 1e-9 of the chords and be tangent to 1e-6 rad (std::logic_error, also when empty).
[[nodiscard]] SplineProjection project_spline(std::span<const Bezier> chain, Continuity continuity);

struct SplitPiece {
  double from = 0, to = 0;  // parameters of the Bezier
  Elastica elastica;        // ends in the Bezier's points and tangents there
  double deviation = 0;     // proven upper bound of the Hausdorff distance to the Bezier's piece
};

struct ElasticaSplit {
  std::vector<SplitPiece> pieces;
  bool within = false;  // false, without pieces: not even pieces of one candidate's length are within
};

// The fewest elastica, tangent at their joints, that stay within `tolerance` (Hausdorff, both ways) of the
// Bezier. Joints are sought at `candidates` - 1 inner places, even by arc length; among them the number is
// the least one, as all places that k pieces can end at are found before any of k + 1. std::logic_error
// unless tolerance > 0 and 1 <= candidates <= 256.
[[nodiscard]] ElasticaSplit split_to_elastica(const Bezier& bezier, double tolerance, int candidates = 16);

}  // namespace hotblade::elastica
