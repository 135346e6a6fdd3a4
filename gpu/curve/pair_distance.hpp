// Measures cubic Beziers against elastica in bulk, pair by pair, on either backend: the paper's L2 and H1
// (Brander, Bærentzen, Fisker, Gravesen, "Bezier curves that are close to elastica", section 2) and the
// Hausdorff distance with a bound of its error; the numbers of elastica/bezier/curve_distance.hpp. The
// elastica is sampled by Taylor steps of its state form; no fit and no closed form takes part.
//
// Promise: an answer has the same bits whatever the backend, the instruction set, the number of threads and
// the other pairs of the call. Only + - * / and square roots of IEEE 754 reach the kernels, in one order, and
// none is fused; what needs more (sine and cosine of a start, counts, the careful search) is computed on the
// host for every backend.
//
// How: the kernels of elastica/kernels/curve_pair.h, a pair a lane or a work item, run the elastica along by
// Taylor steps. Their Hausdorff bounds are narrow for curves that follow each other; the rest gets the search
// of elastica/kernels/hausdorff_search.hpp on the host. Working memory is some 400 kB a thread on the host,
// whatever the number of pairs: more pairs than fit in memory go through in parts.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "gpu/backend/backend.hpp"

namespace hotblade::gpu {

// Holds the members of elastica::Elastica, in its order and units.
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

// Holds a pair's answer; a number is NaN where there is none.
struct PairDistance {
  double l2 = 0, h1 = 0;       // pure numbers, relative to the Bezier's length
  double hausdorff = 0;        // upper bound, unit of the input
  double hausdorff_error = 0;  // by how much it may be too large
  PairStatus status = PairStatus::kOk;
};

// Answers concurrent queries safely.
class PairDistances {
 public:
  explicit PairDistances(Backend backend = Backend::kCpu);
  ~PairDistances();
  PairDistances(PairDistances&&) noexcept;
  PairDistances& operator=(PairDistances&&) noexcept;

  // Writes Bezier i against elastica i to out[i]. `tolerance`, in the unit of the input, is what
  // hausdorff_error shall not exceed; below 4e-10 of the pair's size (extent of the Bezier seen from the
  // elastica's start, or the elastica's length) rounding, which the error includes, keeps it wide. L2 and H1
  // of ribs are within 2e-4 of themselves, those of any cubic within 1 %, 3 % of H1 at a cusp
  // (docs/distances.md). Runs on all cores allowed. Returns how many pairs needed the careful search. Throws
  // std::logic_error when the spans differ in size or unless tolerance > 0.
  std::size_t query(std::span<const std::array<Eigen::Vector2d, 4>> beziers,
                    std::span<const ElasticaState> elastica, double tolerance,
                    std::span<PairDistance> out) const;

  // Returns what answered the last query, and why.
  [[nodiscard]] BackendUse used() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Largest length * sqrt(kappa_max^2 + |lambda|): some sixty turns, beyond what any blade takes.
inline constexpr double kMostWinding = 400;
// What steps and rounding take from a point, relative to the pair's size.
inline constexpr double kPairErrorRel = 1e-10;

}  // namespace hotblade::gpu
