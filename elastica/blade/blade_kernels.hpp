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

// The largest power of two that is no larger, of positive numbers.
HOTBLADE_LANES_INLINE hb_lanes floor_power(hb_lanes v) {
  constexpr long long kExponent = 0x7ff0'0000'0000'0000;
  return (hb_lanes)((hb_lanes_mask)v & kExponent);
}

// Over how many evenly spaced places a series goes on before the next begins at the last of them: a power of
// two, so that the series of different blades begin together and no lane makes the others wait; below 1 where
// it does not reach the next place.
HOTBLADE_LANES_INLINE hb_lanes places_of(hb_lanes reach, hb_lanes spacing) {
  return floor_power(reach / HB_ABS(spacing));
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

// Evenly spaced places on a blade, by the series about one of them as far as that reaches; then about the
// last. What a lane comes to depends on its own blade and places alone.
struct PlaceSeries {
  hb_lanes reach, per_reach, places;
  hb_lanes number;  // of the centre
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

// At place 0, whose series is not expanded yet: one place alone needs none.
HOTBLADE_LANES_INLINE void begin(const BladeField& f, hb_lanes at, hb_lanes spacing, PlaceSeries& s) {
  s.reach = series_reach(f);
  s.per_reach = 1.0 / s.reach;
  s.places = places_of(s.reach, spacing);
  s.number = HB_BROADCAST(0.0);
  s.center.p = f.start;
  s.center.turn = hb_elastica_move_turning(&f.field, at, &s.center.p);
  s.center.at = at;
  s.last = s.center;
}

// What the tangent at the last place is.
HOTBLADE_LANES_INLINE void turn_there(PlaceSeries& s) {
  const hb_lanes u = (s.last.at - s.center.at) * s.per_reach;
  s.last.p.c = hb_elastica_sum(s.tangent.c, u);
  s.last.p.s = hb_elastica_sum(s.tangent.s, u);
  s.last.turn = HB_FMA(u, hb_elastica_sum(s.turn, u), s.center.turn);
}

// From place number - 1 to the next; where the tangent is not asked for, it is found where a series begins.
HOTBLADE_LANES_INLINE void go_on(const BladeField& f, double number, hb_lanes to, bool tangents,
                                 PlaceSeries& s) {
  const hb_lanes_mask out = number - s.number > s.places;
  if (HB_ANY(out)) {
    if (!tangents) turn_there(s);
    // Where a series does not reach the next place, it begins there.
    const hb_lanes_mask far = out & (s.places < HB_BROADCAST(1.0));
    if (HB_ANY(far)) {
      BladePlace there = s.last;
      there.turn +=
          hb_elastica_move_turning(&f.field, HB_SELECT(far, to - s.last.at, HB_BROADCAST(0.0)), &there.p);
      there.at = to;
      s.last = select(far, there, s.last);
    }
    s.number = HB_SELECT(far, HB_BROADCAST(number), HB_SELECT(out, HB_BROADCAST(number - 1), s.number));
    s.center = select(out, s.last, s.center);
    expand(f, s);
  }
  const hb_lanes shift = to - s.center.at, u = shift * s.per_reach;
  s.last.p.x = HB_FMA(shift, hb_elastica_sum(s.x, u), s.center.p.x);
  s.last.p.y = HB_FMA(shift, hb_elastica_sum(s.y, u), s.center.p.y);
  s.last.at = to;
  if (tangents) turn_there(s);
}

HOTBLADE_LANES_INLINE void even_points_of(const PartLanes& b, size_t n, bool tangents) {
  const double between = b.points > 1 ? 1.0 / static_cast<double>(b.points - 1) : 0;
  for (size_t i = 0; i < n; i += HB_LANES) {
    const size_t count = n - i < HB_LANES ? n - i : HB_LANES;
    const BladeField f = load_blades(b.blades, i, count);
    const hb_lanes first = hb_load(b.first + i, count), last = hb_load(b.last + i, count);
    PlaceSeries s;
    begin(f, first, (last - first) * between, s);
    if (b.points > 1) expand(f, s);
    for (size_t k = 0; k < b.points; ++k) {
      const double share = b.points > 1 ? static_cast<double>(k) / static_cast<double>(b.points - 1) : 0;
      if (k > 0) go_on(f, static_cast<double>(k), first + (last - first) * share, tangents, s);
      scatter(b.x, b, i, k, s.last.p.x, count);
      scatter(b.y, b, i, k, s.last.p.y, count);
      if (!tangents) continue;
      scatter(b.cos, b, i, k, s.last.p.c, count);
      scatter(b.sin, b, i, k, s.last.p.s, count);
      scatter(b.turn, b, i, k, s.last.turn, count);
    }
  }
}

[[maybe_unused]] void even_points(const PartLanes& b, size_t n) {
  b.turn ? even_points_of(b, n, true) : even_points_of(b, n, false);
}

// Tangent and curvature of each blade, and the series about a place of it.
struct BladeTangent {
  hb_lanes kappa, c, s;
};
// At evenly spaced places whose distances from the start are `spacing` times their numbers.
struct TangentSeries {
  hb_lanes reach, per_reach, per_place, places;
  hb_lanes number, last_number;  // of the centre and of the last place
  BladeTangent center, last;
  hb_elastica_series series;
};

HOTBLADE_LANES_INLINE void expand(const BladeField& f, TangentSeries& s) {
  hb_elastica_expand(&f.field, s.reach, s.center.kappa, s.center.c, s.center.s, &s.series);
}

// From the blades' starts.
HOTBLADE_LANES_INLINE void begin(const BladeField& f, double spacing, TangentSeries& s) {
  s.reach = series_reach(f);
  s.per_reach = 1.0 / s.reach;
  s.per_place = spacing * s.per_reach;
  s.places = places_of(s.reach, HB_BROADCAST(spacing));
  s.number = s.last_number = HB_BROADCAST(0.0);
  s.center = s.last = {f.field.k, f.start.c, f.start.s};
  expand(f, s);
}

HOTBLADE_LANES_INLINE BladeTangent tangent_at(const TangentSeries& s, hb_lanes number) {
  const hb_lanes u = (number - s.number) * s.per_place;
  return {hb_elastica_sum(s.series.rate, u) * s.per_reach, hb_elastica_sum(s.series.c, u),
          hb_elastica_sum(s.series.s, u)};
}

// Where `out`, the series begins at the last place, whose tangent is `last`.
HOTBLADE_LANES_INLINE void move_center(const BladeField& f, hb_lanes_mask out, const BladeTangent& last,
                                       TangentSeries& s) {
  s.center = {HB_SELECT(out, last.kappa, s.center.kappa), HB_SELECT(out, last.c, s.center.c),
              HB_SELECT(out, last.s, s.center.s)};
  s.number = HB_SELECT(out, s.last_number, s.number);
  expand(f, s);
}

// To a place that a series reaches from the last.
HOTBLADE_LANES_INLINE void go_on(const BladeField& f, double number, TangentSeries& s) {
  const hb_lanes to = HB_BROADCAST(number);
  const hb_lanes_mask out = to - s.number > s.places;
  if (HB_ANY(out)) move_center(f, out, s.last, s);
  s.last = tangent_at(s, to);
  s.last_number = to;
}

// A blade's curvature and its derivative.
struct BladeBend {
  hb_lanes kappa, slope;
};

// To such a place, for the bend alone; s.last is not kept.
HOTBLADE_LANES_INLINE BladeBend bend_on(const BladeField& f, double number, TangentSeries& s) {
  const hb_lanes to = HB_BROADCAST(number);
  const hb_lanes_mask out = to - s.number > s.places;
  if (HB_ANY(out)) move_center(f, out, tangent_at(s, s.last_number), s);
  s.last_number = to;
  const hb_lanes u = (to - s.number) * s.per_place;
  hb_lanes rate = s.series.rate[HB_STEP_ORDER], slope = rate;
  rate = HB_FMA(rate, u, s.series.rate[HB_STEP_ORDER - 1]);
#pragma GCC unroll 16
  for (int k = HB_STEP_ORDER - 2; k >= 0; --k) {
    slope = HB_FMA(slope, u, rate);
    rate = HB_FMA(rate, u, s.series.rate[k]);
  }
  return {rate * s.per_reach, slope * (s.per_reach * s.per_reach)};
}

}  // namespace
}  // namespace hotblade::elastica
