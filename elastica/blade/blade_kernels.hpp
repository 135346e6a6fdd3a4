// The batch loops over blades, SIMD lanes across blades. Only the sources that are compiled once per
// instruction set include it (elastica/kernels/simd_lanes.h).
#pragma once

#include "elastica/kernels/simd_lanes.h"
// The lanes come first: what follows is written in them.
#include "elastica/blade/blade_lanes.hpp"
#include "elastica/kernels/elastica_step.h"

namespace hotblade::elastica {
namespace {

#define HOTBLADE_LANES_INLINE static inline __attribute__((always_inline))

struct BladeField {
  hb_elastica_field field;
  hb_elastica_point start;
};

HOTBLADE_LANES_INLINE BladeField load_blades(const UnitBlades& b, size_t i, size_t count) {
  BladeField f;
  f.field.k = hb_load(b.kappa + i, count);
  f.field.l1 = hb_load(b.lambda1 + i, count);
  f.field.l2 = hb_load(b.lambda2 + i, count);
  // taylor_rate() of elastica/curve/taylor.hpp.
  const hb_lanes force = HB_SQRT(f.field.l1 * f.field.l1 + f.field.l2 * f.field.l2);
  const hb_lanes rate = HB_SQRT(f.field.k * f.field.k + 2.0 * (force - f.field.l1) + force);
  f.field.most_step = HB_BROADCAST(HB_STEP_OMEGA) / rate;
  f.start = {HB_BROADCAST(0.0), HB_BROADCAST(0.0), HB_BROADCAST(1.0), HB_BROADCAST(0.0)};
  return f;
}

// Blade i + lane writes to place (i + lane) * points + k.
HOTBLADE_LANES_INLINE void scatter(double* to, const PartLanes& b, size_t i, size_t k, hb_lanes v,
                                   size_t count) {
  if (!to) return;
  for (size_t lane = 0; lane < count; ++lane) to[(i + lane) * b.points + k] = v[lane];
}

[[maybe_unused]] void even_points(const PartLanes& b, size_t n) {
  for (size_t i = 0; i < n; i += HB_LANES) {
    const size_t count = n - i < HB_LANES ? n - i : HB_LANES;
    const BladeField f = load_blades(b.blades, i, count);
    const hb_lanes first = hb_load(b.first + i, count), last = hb_load(b.last + i, count);
    hb_elastica_point p = f.start;
    hb_lanes turn = HB_BROADCAST(0.0), at = HB_BROADCAST(0.0);
    for (size_t k = 0; k < b.points; ++k) {
      const double share = b.points > 1 ? static_cast<double>(k) / static_cast<double>(b.points - 1) : 0;
      const hb_lanes to = first + (last - first) * share;
      turn += hb_elastica_move_turning(&f.field, to - at, &p);
      at = to;
      scatter(b.x, b, i, k, p.x, count);
      scatter(b.y, b, i, k, p.y, count);
      scatter(b.cos, b, i, k, p.c, count);
      scatter(b.sin, b, i, k, p.s, count);
      scatter(b.turn, b, i, k, turn, count);
    }
  }
}

}  // namespace
}  // namespace hotblade::elastica
