// The lanes of curve_pair.h over many pairs, compiled once for each instruction set; see
// elastica/kernels/simd_lanes.h for what the including file may use.
#pragma once

#include "elastica/kernels/simd_lanes.h"
// Lanes first; products and sums rounded one by one, for the same bits everywhere (pair_lanes.hpp).
#undef HB_FMA
#define HB_FMA(a, b, c) ((a) * (b) + (c))
#include "elastica/kernels/curve_pair.h"
#include "gpu/curve/pair_lanes.hpp"

namespace hotblade::gpu {
namespace {

// Missing lanes repeat the last pair.
inline __attribute__((always_inline)) hb_pair pair_at(const PairQueries& q, std::size_t first) {
  double numbers[16][HB_LANES];
  for (std::size_t i = 0; i < HB_LANES; ++i) {
    const std::size_t at = first + i < q.n ? first + i : q.n - 1;
    for (int k = 0; k < 16; ++k) numbers[k][i] = q.pairs[q.index[at]].v[k];
  }
  HB_REAL v[16];
  for (int k = 0; k < 16; ++k) v[k] = hb_load(numbers[k], HB_LANES);
  const HB_REAL zero = HB_BROADCAST(0.0);
  return {
      v[0],  v[1], v[2], v[3], v[4], v[5], v[6], v[7], {v[8], v[9], v[10], v[11]}, {zero, zero, v[12], v[13]},
      v[14], v[15]};
}

inline __attribute__((always_inline)) void scatter(const PairQueries& q, std::size_t first, HB_REAL v,
                                                   double* to) {
  for (std::size_t i = 0; i < HB_LANES && first + i < q.n; ++i) to[q.index[first + i]] = v[i];
}

void differences_of_pairs(const PairQueries& q, int panels, double* l2, double* h1, double* length) {
  for (std::size_t first = 0; first < q.n; first += HB_LANES) {
    const hb_pair pair = pair_at(q, first);
    const hb_pair_difference d = hb_pair_differences(&pair, panels);
    scatter(q, first, d.l2, l2);
    scatter(q, first, d.h1, h1);
    scatter(q, first, d.length, length);
  }
}

void hausdorff_of_pairs(const PairQueries& q, int samples, double* lower, double* upper) {
  hb_pair_node nodes[kMostPairSamples + 3];
  for (std::size_t first = 0; first < q.n; first += HB_LANES) {
    const hb_pair pair = pair_at(q, first);
    const hb_pair_bounds b = hb_pair_hausdorff(&pair, samples, nodes, 1);
    scatter(q, first, b.lower, lower);
    scatter(q, first, b.upper, upper);
  }
}

}  // namespace
}  // namespace hotblade::gpu
