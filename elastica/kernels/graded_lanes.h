// Many curves in lanes: all by 24 nodes, and those for which these are too few again by graded panels
// (elastica/kernels/graded_residual.h), gathered into lanes of their own. Lanes do not touch each other, so a
// curve's result depends on its own numbers alone. Only for sources that are compiled once per instruction
// set.
#pragma once

#include "elastica/kernels/simd_lanes.h"
// The lanes come first: what follows is written in them.
#include "elastica/kernels/graded_residual.h"

// `plain(first, count)` computes the curves from `first` on and returns which lanes want panels;
// `graded(index, count)` computes those of these numbers by panels, index[count ..] repeating the last.
template <typename Plain, typename Graded>
static inline __attribute__((always_inline)) void hb_each_curve(size_t n, const Plain& plain,
                                                                const Graded& graded) {
  size_t index[HB_LANES], waiting[2 * HB_LANES] = {}, left = 0;
  for (size_t first = 0; first < n; first += HB_LANES) {
    const bool last = n - first <= HB_LANES;
    const size_t count = last ? n - first : HB_LANES;
    const HB_MASK wanted = plain(first, count);
    if (HB_ANY(wanted)) {
      for (size_t i = 0; i < count; ++i) {
        waiting[left] = first + i;
        left += wanted[i] != 0;
      }
    }
    while (left >= HB_LANES || (last && left > 0)) {
      const size_t taken = left < HB_LANES ? left : HB_LANES;
      for (size_t i = 0; i < HB_LANES; ++i) index[i] = waiting[i < taken ? i : taken - 1];
      graded(index, taken);
      left -= taken;
      for (size_t i = 0; i < left; ++i) waiting[i] = waiting[taken + i];
    }
  }
}
