// The smallest eigenvalue of elastica/blade/stability.hpp over SIMD lanes: the same search lane by lane as
// in stability.cpp, where its steps are explained. Only the sources that are compiled once per instruction
// set include it.
#pragma once

#include "elastica/blade/blade_kernels.hpp"

namespace hotblade::elastica {
namespace {

constexpr size_t kMarginInner = kMarginCells - 1;
constexpr double kMarginOff = -static_cast<double>(kMarginCells) * kMarginCells;

// H of every lane's blade: a tridiagonal matrix bordered by two orthonormal constraints. What a shift by
// sigma leaves of them after the elimination, and the vector of the search.
struct MarginWork {
  hb_lanes diagonal[kMarginInner], first[kMarginInner], second[kMarginInner];
  hb_lanes inverse[kMarginInner], reduced_first[kMarginInner], reduced_second[kMarginInner];
  hb_lanes start[kMarginInner], v[kMarginInner];
};
static_assert(sizeof(MarginWork) <= kScratchDoubles * sizeof(double));

// The constraints' Schur complement, and the number of the elimination's pivots below zero.
struct MarginInertia {
  hb_lanes s00, s01, s11, negative;
};

HOTBLADE_LANES_INLINE hb_lanes margin_dot(const hb_lanes* a, const hb_lanes* b) {
  hb_lanes sum = HB_BROADCAST(0.0);
  for (size_t i = 0; i < kMarginInner; ++i) sum = HB_FMA(a[i], b[i], sum);
  return sum;
}

// to += times v, then scaled.
HOTBLADE_LANES_INLINE void margin_add(hb_lanes* to, hb_lanes times, const hb_lanes* v) {
  for (size_t i = 0; i < kMarginInner; ++i) to[i] = HB_FMA(times, v[i], to[i]);
}

HOTBLADE_LANES_INLINE void margin_scale(hb_lanes* v, hb_lanes by) {
  for (size_t i = 0; i < kMarginInner; ++i) v[i] = v[i] * by;
}

void margin_march(const BladeField& f, MarginWork& w) {
  TangentSeries at;
  begin(f, 1.0 / kMarginCells, at);
  for (size_t i = 0; i < kMarginInner; ++i) {
    go_on(f, static_cast<double>(i + 1), at);
    w.diagonal[i] = -2.0 * kMarginOff - HB_FMA(f.field.l1, at.last.c, f.field.l2 * at.last.s);
    w.first[i] = at.last.c;
    w.second[i] = at.last.s;
  }
}

// Returns where there are two constraints; elsewhere the second one is zero.
hb_lanes_mask margin_constraints(MarginWork& w) {
  // Turned by the middle tangent: on a straight blade the second constraint is then empty.
  const hb_lanes cm = w.first[kMarginInner / 2], sm = w.second[kMarginInner / 2];
  for (size_t i = 0; i < kMarginInner; ++i) {
    const hb_lanes c = w.first[i], s = w.second[i];
    w.first[i] = HB_FMA(c, cm, s * sm);
    w.second[i] = HB_FMA(s, cm, -(c * sm));
  }
  const hb_lanes one = HB_BROADCAST(1.0), zero = HB_BROADCAST(0.0);
  margin_scale(w.first, one / HB_SQRT(margin_dot(w.first, w.first)));
  margin_add(w.second, -margin_dot(w.second, w.first), w.first);
  const hb_lanes rest = HB_SQRT(margin_dot(w.second, w.second));
  constexpr double kEmpty = 1e-7, kRootOfInner = 11.269427669584644;
  const hb_lanes_mask two = rest > HB_BROADCAST(kEmpty * kRootOfInner);
  const hb_lanes inverse = one / rest;
  margin_scale(w.second, HB_SELECT(two, inverse, zero));
  return two;
}

void margin_start(MarginWork& w) {
  for (size_t i = 0; i < kMarginInner; ++i) {
    const double s = static_cast<double>(i + 1) / kMarginCells;
    w.start[i] = HB_BROADCAST(s * (1 - s) * (1 + 2.3 * s * s * s));
  }
  margin_add(w.start, -margin_dot(w.start, w.first), w.first);
  margin_add(w.start, -margin_dot(w.start, w.second), w.second);
  margin_scale(w.start, HB_BROADCAST(1.0) / HB_SQRT(margin_dot(w.start, w.start)));
  for (size_t i = 0; i < kMarginInner; ++i) w.v[i] = w.start[i];
}

// Eliminates H - sigma. With kSolve the right side v / size goes along, and `right` gets its products with
// the constraints.
template <bool kSolve>
HOTBLADE_LANES_INLINE MarginInertia margin_eliminate(MarginWork& w, hb_lanes sigma, hb_lanes scale,
                                                     hb_lanes* right) {
  const hb_lanes zero = HB_BROADCAST(0.0), one = HB_BROADCAST(1.0), off = HB_BROADCAST(kMarginOff);
  const hb_lanes tiny = HB_BROADCAST(-kMarginOff * 1e-16);
  MarginInertia m = {zero, zero, zero, zero};
  hb_lanes before = zero, a = zero, b = zero, x = zero, right0 = zero, right1 = zero;
  for (size_t i = 0; i < kMarginInner; ++i) {
    const hb_lanes factor = off * before;
    hb_lanes pivot = HB_FMA(-factor, off, w.diagonal[i] - sigma);
    pivot = HB_SELECT(pivot == zero, tiny, pivot);
    m.negative += HB_SELECT(pivot < zero, one, zero);
    before = one / pivot;
    a = HB_FMA(-factor, a, w.first[i]);
    b = HB_FMA(-factor, b, w.second[i]);
    const hb_lanes ap = a * before, bp = b * before;
    m.s00 = HB_FMA(-a, ap, m.s00);
    m.s01 = HB_FMA(-b, ap, m.s01);
    m.s11 = HB_FMA(-b, bp, m.s11);
    if (kSolve) {
      x = HB_FMA(-factor, x, w.v[i] * scale);
      right0 = HB_FMA(ap, x, right0);
      right1 = HB_FMA(bp, x, right1);
      w.inverse[i] = before;
      w.reduced_first[i] = a;
      w.reduced_second[i] = b;
      w.v[i] = x;
    }
  }
  if (kSolve) {
    right[0] = right0;
    right[1] = right1;
  }
  return m;
}

HOTBLADE_LANES_INLINE hb_lanes margin_below(const MarginInertia& m, hb_lanes_mask two) {
  const hb_lanes zero = HB_BROADCAST(0.0), one = HB_BROADCAST(1.0);
  const hb_lanes det = m.s00 * m.s11 - m.s01 * m.s01;
  const hb_lanes of_two =
      HB_SELECT(det < zero, one, HB_SELECT(m.s00 + m.s11 < zero, one + one, zero)) - (one + one);
  const hb_lanes of_one = HB_SELECT(m.s00 < zero, zero, -one);
  return m.negative + HB_SELECT(two, of_two, of_one);
}

// The multipliers of the constraints.
HOTBLADE_LANES_INLINE void margin_held(const MarginInertia& m, hb_lanes_mask two, const hb_lanes* right,
                                       hb_lanes* held) {
  const hb_lanes zero = HB_BROADCAST(0.0), tiny = HB_BROADCAST(1e-300);
  const hb_lanes det = m.s00 * m.s11 - m.s01 * m.s01;
  const hb_lanes by =
      HB_SELECT(two, HB_SELECT(det == zero, tiny, det), HB_SELECT(m.s00 == zero, tiny, m.s00));
  const hb_lanes first = m.s11 * right[0] - m.s01 * right[1], second = m.s00 * right[1] - m.s01 * right[0];
  held[0] = -HB_SELECT(two, first, right[0]) / by;
  held[1] = HB_SELECT(two, -second / by, zero);
}

// Back substitution; v becomes the solution. Returns its squared size and its energy in `energy`.
HOTBLADE_LANES_INLINE hb_lanes margin_substitute(MarginWork& w, const hb_lanes* held, hb_lanes* energy) {
  const hb_lanes off = HB_BROADCAST(kMarginOff), cells = HB_BROADCAST(static_cast<double>(kMarginCells));
  hb_lanes after = HB_BROADCAST(0.0), size = after, sum = after;
  for (size_t i = kMarginInner; i-- > 0;) {
    const hb_lanes rest = w.v[i] - HB_FMA(held[0], w.reduced_first[i], held[1] * w.reduced_second[i]);
    const hb_lanes x = HB_FMA(-off, after, rest) * w.inverse[i];
    const hb_lanes slope = (after - x) * cells;
    size = HB_FMA(x, x, size);
    sum = HB_FMA(slope, slope, HB_FMA((w.diagonal[i] + 2.0 * kMarginOff) * x, x, sum));
    w.v[i] = x;
    after = x;
  }
  *energy = HB_FMA(after * cells, after * cells, sum);
  return size;
}

HOTBLADE_LANES_INLINE hb_lanes margin_slack(hb_lanes a, hb_lanes b) {
  constexpr double kRelative = 1e-6;
  return kRelative * (1.0 + HB_ABS(a) + HB_ABS(b));
}

// The state of every lane's search.
struct MarginSearch {
  hb_lanes low, high, sigma, last, scale, result;
  hb_lanes_mask third_power;  // sigma is a quotient itself
  hb_lanes_mask searching;
};

// Lanes whose vector was lost start again half-way.
HOTBLADE_LANES_INLINE void margin_restart(MarginWork& w, hb_lanes_mask lost, MarginSearch& s) {
  for (size_t i = 0; i < kMarginInner; ++i) w.v[i] = HB_SELECT(lost, w.start[i], w.v[i]);
  s.scale = HB_SELECT(lost, HB_BROADCAST(1.0), s.scale);
  s.sigma = HB_SELECT(lost, 0.5 * (s.low + s.high), s.sigma);
  s.third_power &= ~lost;
}

void margin_step(MarginWork& w, hb_lanes_mask two, MarginSearch& s) {
  const hb_lanes zero = HB_BROADCAST(0.0), one = HB_BROADCAST(1.0);
  hb_lanes right[2], held[2], energy;
  const MarginInertia inertia = margin_eliminate<true>(w, s.sigma, s.scale, right);
  const hb_lanes_mask below = margin_below(inertia, two) > zero;
  s.high = HB_SELECT(s.searching & below, s.sigma, s.high);
  s.low = HB_SELECT(s.searching & ~below, s.sigma, s.low);
  margin_held(inertia, two, right, held);
  const hb_lanes size = margin_substitute(w, held, &energy);
  const hb_lanes_mask kept = (size > zero) & (size - size == zero);
  const hb_lanes quotient = energy / size, half = 0.5 * (s.low + s.high);
  s.scale = one / HB_SQRT(size);
  constexpr double kNearlySettled = 1e-3;
  const hb_lanes_mask settled =
      s.third_power & (HB_ABS(quotient - s.last) < kNearlySettled * (one + HB_ABS(quotient)));
  s.last = HB_SELECT(kept, quotient, s.last);
  const hb_lanes_mask inside =
      kept & (quotient > s.low) & (quotient < s.high + margin_slack(quotient, s.high));
  s.third_power = inside;
  s.sigma = HB_SELECT(inside, quotient, half);
  const hb_lanes_mask ask = s.searching & inside & settled;
  if (HB_ANY(ask)) {
    const hb_lanes at = quotient - 0.5 * margin_slack(quotient, quotient);
    const MarginInertia there = margin_eliminate<false>(w, at, one, right);
    const hb_lanes_mask smallest = (at <= s.low) | ~(margin_below(there, two) > zero);
    s.result = HB_SELECT(ask & smallest, quotient, s.result);
    s.searching &= ~(ask & smallest);
    s.high = HB_SELECT(ask & ~smallest, at, s.high);
    s.sigma = HB_SELECT(ask & ~smallest, 0.5 * (s.low + s.high), s.sigma);
    s.third_power &= ~(ask & ~smallest);
  }
  if (HB_ANY(s.searching & ~kept)) margin_restart(w, ~kept, s);
  const hb_lanes_mask wide = s.high - s.low > margin_slack(s.low, s.high);
  const hb_lanes_mask between =
      (s.last > s.low - margin_slack(s.last, s.low)) & (s.last < s.high + margin_slack(s.last, s.high));
  s.result = HB_SELECT(s.searching & ~wide, HB_SELECT(between, s.last, 0.5 * (s.low + s.high)), s.result);
  s.searching &= wide;
}

[[maybe_unused]] void stability_margins_of(const MarginLanes& b, size_t n) {
  MarginWork& w = *reinterpret_cast<MarginWork*>(b.scratch);
  for (size_t i = 0; i < n; i += HB_LANES) {
    const size_t count = n - i < HB_LANES ? n - i : HB_LANES;
    const BladeField f = load_blades(b.blades, i, count);
    margin_march(f, w);
    const hb_lanes_mask two = margin_constraints(w);
    margin_start(w);
    const hb_lanes load = HB_SQRT(f.field.l1 * f.field.l1 + f.field.l2 * f.field.l2);
    MarginSearch s;
    s.low = -load - 1.0;
    s.high = 100.0 + load;
    s.sigma = s.low;
    s.last = s.high;
    s.scale = HB_BROADCAST(1.0);
    s.result = HB_BROADCAST(0.0);
    s.searching = s.high > s.low;
    s.third_power = ~s.searching;
    while (HB_ANY(s.searching)) margin_step(w, two, s);
    hb_store(b.margin + i, s.result, count);
  }
}

}  // namespace
}  // namespace hotblade::elastica
