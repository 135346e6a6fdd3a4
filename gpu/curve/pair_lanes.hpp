// Measures pairs of curves in lanes, by the kernels of elastica/kernels/curve_pair.h, for the instruction set
// at hand. No lanes fuse a multiplication with an addition, so every instruction set computes the same bits,
// as does a device that rounds as IEEE 754 says (gpu/kernels/pair_distance.cl).
#pragma once

#include <cstddef>

namespace hotblade::gpu {

// Holds a Bezier and an elastica that starts at the origin as the numbers of hb_pair
// (elastica/kernels/curve_pair.h): x and y of the Bezier in powers of t; kappa, lambda1, lambda2 and longest
// step of the elastica; cosine and sine at its start; its length and largest |kappa|.
struct PairNumbers {
  double v[16];
};

// Panels of L2 and H1, and samples of the Hausdorff distance: these, times powers of two.
inline constexpr int kLeastPairPanels = 8, kLeastPairSamples = 16;
inline constexpr int kMostPairSamples = 512;

// Asks for the pairs number index[0 .. n); answers stand at the same numbers.
struct PairQueries {
  const PairNumbers* pairs;
  const unsigned* index;
  std::size_t n;
};

// The first gives L2, H1 and the Bezier's length; the second gives bounds of the Hausdorff distance.
struct PairLanes {
  void (*differences)(const PairQueries& queries, int panels, double* l2, double* h1, double* length);
  void (*hausdorff)(const PairQueries& queries, int samples, double* lower, double* upper);
};

extern const PairLanes kPairBaseline, kPairAvx2, kPairAvx512;

// Returns the widest that this processor runs.
[[nodiscard]] const PairLanes& pair_lanes();

}  // namespace hotblade::gpu
