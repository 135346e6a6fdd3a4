// Cubic Beziers against elastica in bulk, pair by pair: the paper's L2 and H1 (Brander, Bærentzen, Fisker,
// Gravesen, "Bezier curves that are close to elastica", section 2) and the Hausdorff distance with a bound of
// its error; the numbers of elastica/bezier/curve_distance.hpp.
//
// How: kernels of elastica/kernels/curve_pair.h on the processor's vector units, a pair a lane, run the
// elastica along by Taylor steps. Their Hausdorff bounds are narrow for curves that follow each other; the
// rest gets the search of elastica/kernels/hausdorff_search.hpp. Working memory is some 400 kB a thread,
// whatever the number of pairs, and a pair's answer has the same bits whatever its company or the number of
// threads: more pairs than fit in memory go through in parts. Instruction sets differ by rounding.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace hotblade::gpu {

// The members of elastica::Elastica, in its order and units.
struct ElasticaState {
  double x = 0, y = 0, theta = 0;
  double kappa = 0;
  double lambda1 = 0, lambda2 = 0;
  double length = 0;
};

enum class PairStatus : std::uint8_t {
  kOk,
  kWide,      // hausdorff holds, but its error is above the tolerance
  kNoLength,  // the Bezier is one point: no L2 and H1; hausdorff holds, within hausdorff_error
  kTooTight,  // the elastica winds more than kMostWinding: no answer
  kInvalid,   // a number is not finite, an extent beyond 1e140, or the length below 0: no answer
};

// NaN where there is no answer.
struct PairDistance {
  double l2 = 0, h1 = 0;       // pure numbers, relative to the Bezier's length
  double hausdorff = 0;        // upper bound, unit of the input
  double hausdorff_error = 0;  // by how much it may be too large
  PairStatus status = PairStatus::kOk;
};

// Bezier i against elastica i. `tolerance`, in the unit of the input, is what hausdorff_error shall not
// exceed; below 4e-10 of the pair's size (extent of the Bezier seen from the elastica's start, or the
// elastica's length) rounding, which the error includes, keeps it wide. Runs on all cores allowed. Returns
// how many pairs needed the careful search. Throws std::logic_error when the spans differ in size or unless
// tolerance > 0.
std::size_t pair_distances(std::span<const std::array<Eigen::Vector2d, 4>> beziers,
                           std::span<const ElasticaState> elastica, double tolerance,
                           std::span<PairDistance> out);

// Largest length * sqrt(kappa_max^2 + |lambda|): some sixty turns, beyond what any blade takes.
inline constexpr double kMostWinding = 400;
// What steps and rounding take from a point, relative to the pair's size.
inline constexpr double kPairErrorRel = 1e-10;

}  // namespace hotblade::gpu
