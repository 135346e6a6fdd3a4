// What is computed curve by curve in lanes, for the instruction set at hand.
#pragma once

#include <cstddef>
#include <cstdint>

#include "gpu/kernels/curve_pieces.h"

namespace hotblade::gpu {

// n points (x - ox, y - oy) scale of the curve's frame; distances are given unscaled. `unsure` has room for n
// + 8 and gets the numbers of the points that are not proven.
struct CurveQueries {
  const double *x, *y;
  double ox, oy, scale;
  std::size_t n;
  double *distance, *t;
  unsigned* unsure;
};

// A Bezier and an elastica that starts at the origin, the numbers of hb_pair (elastica/kernels/curve_pair.h):
// x and y of the Bezier in powers of t; kappa, lambda1, lambda2 and longest step of the elastica; cosine and
// sine at its start; its length and largest |kappa|.
struct PairNumbers {
  double v[16];
};

// Most samples of a pair's Hausdorff distance.
inline constexpr int kMostPairSamples = 512;

// Pairs number index[0 .. n); answers stand at the same numbers.
struct PairQueries {
  const PairNumbers* pairs;
  const unsigned* index;
  std::size_t n;
};

// The first two return how many are unsure (kernels/curve_nearest.h). The third takes eight numbers a curve
// and gives the residual and its status code. The last two are for pairs of curves.
struct CurveLanes {
  std::size_t (*whole)(const hb_curve_whole& curve, const CurveQueries& queries);
  std::size_t (*pieces)(const hb_curve_piece* pieces, int count, double sag, const CurveQueries& queries);
  void (*residuals)(const double* curves, std::size_t n, double* e, std::uint8_t* status);
  void (*differences)(const PairQueries& queries, int panels, double* l2, double* h1, double* length);
  void (*hausdorff)(const PairQueries& queries, int samples, double* lower, double* upper);
};

extern const CurveLanes kCurveBaseline, kCurveAvx2, kCurveAvx512;

// The widest that this processor runs.
[[nodiscard]] const CurveLanes& curve_lanes();

}  // namespace hotblade::gpu
