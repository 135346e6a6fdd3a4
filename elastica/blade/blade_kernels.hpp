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

// How far a series about a point of each blade reaches, unit blades being no longer than this.
HOTBLADE_LANES_INLINE hb_lanes series_reach(const BladeField& f) {
  return HB_MIN(f.field.most_step, HB_BROADCAST(1.0));
}

// A place on each blade and what the tangent has turned by up to there.
struct BladePlace {
  hb_elastica_point p;
  hb_lanes turn, at;
};

HOTBLADE_LANES_INLINE BladePlace select(hb_lanes_mask where, const BladePlace& a, const BladePlace& b) {
  return {{HB_SELECT(where, a.p.x, b.p.x), HB_SELECT(where, a.p.y, b.p.y), HB_SELECT(where, a.p.c, b.p.c),
           HB_SELECT(where, a.p.s, b.p.s)},
          HB_SELECT(where, a.turn, b.turn),
          HB_SELECT(where, a.at, b.at)};
}

// Places that follow each other on a blade, in either sense, by the series about one of them as far as that
// reaches; then about the last. What a lane comes to depends on its own blade and places alone.
struct PlaceSeries {
  hb_lanes reach, per_reach;
  BladePlace center, last;
  hb_elastica_series tangent;
  hb_lanes x[HB_STEP_ORDER + 1], y[HB_STEP_ORDER + 1], turn[HB_STEP_ORDER + 1];
};

HOTBLADE_LANES_INLINE void expand(const BladeField& f, PlaceSeries& s) {
  hb_elastica_expand(&f.field, s.reach, hb_elastica_curvature(&f.field, &s.center.p), s.center.p.c,
                     s.center.p.s, &s.tangent);
#pragma GCC unroll 16
  for (int k = 0; k <= HB_STEP_ORDER; ++k) {
    const hb_lanes per = HB_BROADCAST(1.0 / (k + 1));
    s.x[k] = s.tangent.c[k] * per;
    s.y[k] = s.tangent.s[k] * per;
    s.turn[k] = s.tangent.rate[k] * per;
  }
}

// At the first place, whose series is not expanded yet: one place alone needs none.
HOTBLADE_LANES_INLINE void begin(const BladeField& f, hb_lanes at, PlaceSeries& s) {
  s.reach = series_reach(f);
  s.per_reach = 1.0 / s.reach;
  s.center.p = f.start;
  s.center.turn = hb_elastica_move_turning(&f.field, at, &s.center.p);
  s.center.at = at;
  s.last = s.center;
}

HOTBLADE_LANES_INLINE void go_on(const BladeField& f, hb_lanes to, PlaceSeries& s) {
  const hb_lanes_mask out = HB_ABS(to - s.center.at) > s.reach;
  if (HB_ANY(out)) {
    // Where the next place lies out of the last one's reach too, the series begins there.
    const hb_lanes step = to - s.last.at;
    const hb_lanes_mask far = HB_ABS(step) > s.reach;
    if (HB_ANY(far)) {
      BladePlace there = s.last;
      there.turn += hb_elastica_move_turning(&f.field, HB_SELECT(far, step, HB_BROADCAST(0.0)), &there.p);
      there.at = to;
      s.last = select(far, there, s.last);
    }
    s.center = select(out, s.last, s.center);
    expand(f, s);
  }
  const hb_lanes u = (to - s.center.at) * s.per_reach, shift = to - s.center.at;
  s.last.p.c = hb_elastica_sum(s.tangent.c, u);
  s.last.p.s = hb_elastica_sum(s.tangent.s, u);
  s.last.p.x = HB_FMA(shift, hb_elastica_sum(s.x, u), s.center.p.x);
  s.last.p.y = HB_FMA(shift, hb_elastica_sum(s.y, u), s.center.p.y);
  s.last.turn = HB_FMA(u, hb_elastica_sum(s.turn, u), s.center.turn);
  s.last.at = to;
}

[[maybe_unused]] void even_points(const PartLanes& b, size_t n) {
  for (size_t i = 0; i < n; i += HB_LANES) {
    const size_t count = n - i < HB_LANES ? n - i : HB_LANES;
    const BladeField f = load_blades(b.blades, i, count);
    const hb_lanes first = hb_load(b.first + i, count), last = hb_load(b.last + i, count);
    PlaceSeries s;
    begin(f, first, s);
    if (b.points > 1) expand(f, s);
    for (size_t k = 0; k < b.points; ++k) {
      const double share = b.points > 1 ? static_cast<double>(k) / static_cast<double>(b.points - 1) : 0;
      if (k > 0) go_on(f, first + (last - first) * share, s);
      scatter(b.x, b, i, k, s.last.p.x, count);
      scatter(b.y, b, i, k, s.last.p.y, count);
      scatter(b.cos, b, i, k, s.last.p.c, count);
      scatter(b.sin, b, i, k, s.last.p.s, count);
      scatter(b.turn, b, i, k, s.last.turn, count);
    }
  }
}

// Tangent and curvature of each blade, and the series about a place of it.
struct BladeTangent {
  hb_lanes kappa, c, s;
};
struct TangentSeries {
  hb_lanes reach, per_reach, center_at, last_at;
  BladeTangent center, last;
  hb_elastica_series series;
};

HOTBLADE_LANES_INLINE void expand(const BladeField& f, TangentSeries& s) {
  hb_elastica_expand(&f.field, s.reach, s.center.kappa, s.center.c, s.center.s, &s.series);
}

// From the blades' starts.
HOTBLADE_LANES_INLINE void begin(const BladeField& f, TangentSeries& s) {
  s.reach = series_reach(f);
  s.per_reach = 1.0 / s.reach;
  s.center_at = s.last_at = HB_BROADCAST(0.0);
  s.center = s.last = {f.field.k, f.start.c, f.start.s};
  expand(f, s);
}

// On by a step that a series reaches.
HOTBLADE_LANES_INLINE void go_on(const BladeField& f, double to, TangentSeries& s) {
  const hb_lanes at = HB_BROADCAST(to);
  const hb_lanes_mask out = at - s.center_at > s.reach;
  if (HB_ANY(out)) {
    s.center = {HB_SELECT(out, s.last.kappa, s.center.kappa), HB_SELECT(out, s.last.c, s.center.c),
                HB_SELECT(out, s.last.s, s.center.s)};
    s.center_at = HB_SELECT(out, s.last_at, s.center_at);
    expand(f, s);
  }
  const hb_lanes u = (at - s.center_at) * s.per_reach;
  s.last = {hb_elastica_sum(s.series.rate, u) * s.per_reach, hb_elastica_sum(s.series.c, u),
            hb_elastica_sum(s.series.s, u)};
  s.last_at = at;
}

}  // namespace
}  // namespace hotblade::elastica
