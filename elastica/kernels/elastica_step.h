/* An elastica in state form, run along by steps of its Taylor series (elastica/curve/taylor.hpp): every lane
 * its own curve and its own distance. */
#ifndef HOTBLADE_ELASTICA_KERNELS_ELASTICA_STEP_H
#define HOTBLADE_ELASTICA_KERNELS_ELASTICA_STEP_H

#include "elastica/kernels/real.h"

/* A step of order 10 with omega times its length at most HB_STEP_OMEGA leaves out less than (0.2 / 2.8)^11 =
 * 3e-13 of itself, omega^2 = kappa_max^2 + |lambda|. */
#define HB_STEP_ORDER 10
#define HB_STEP_OMEGA 0.2

/* kappa = k - l1 y + l2 x. No step is longer than `most_step`. */
typedef struct {
  HB_REAL k, l1, l2, most_step;
} hb_elastica_field;

/* Position and unit tangent. */
typedef struct {
  HB_REAL x, y, c, s;
} hb_elastica_point;

HB_INLINE HB_REAL hb_elastica_curvature(const hb_elastica_field* f, const hb_elastica_point* p) {
  return HB_FMA(f->l2, p->x, HB_FMA(-f->l1, p->y, f->k));
}

/* The Taylor series about a point of the cosine and sine of the tangent's angle and of its rate, the
 * curvature times h, in powers of the arc length over h. */
typedef struct {
  HB_REAL c[HB_STEP_ORDER + 1], s[HB_STEP_ORDER + 1], rate[HB_STEP_ORDER + 1];
} hb_elastica_series;

HB_INLINE void hb_elastica_expand(const hb_elastica_field* f, HB_REAL h, HB_REAL kappa, HB_REAL cos,
                                  HB_REAL sin, hb_elastica_series* at) {
  const HB_REAL t1 = f->l1 * (h * h), t2 = f->l2 * (h * h);
  at->c[0] = cos;
  at->s[0] = sin;
  at->rate[0] = h * kappa;
#pragma GCC unroll 16
  for (int k = 0; k < HB_STEP_ORDER; ++k) {
    const HB_REAL per = HB_BROADCAST(1.0 / (k + 1));
    HB_REAL dc = at->rate[0] * at->s[k], ds = at->rate[0] * at->c[k];
    at->rate[k + 1] = HB_FMA(t2, at->c[k], -(t1 * at->s[k])) * per;
#pragma GCC unroll 16
    for (int j = 1; j <= k; ++j) {
      dc = HB_FMA(at->rate[j], at->s[k - j], dc);
      ds = HB_FMA(at->rate[j], at->c[k - j], ds);
    }
    at->c[k + 1] = -(dc * per);
    at->s[k + 1] = ds * per;
  }
}

/* The sum of coefficients times powers of u, |u| <= 1. */
HB_INLINE HB_REAL hb_elastica_sum(const HB_REAL* coefficients, HB_REAL u) {
  HB_REAL sum = coefficients[HB_STEP_ORDER];
#pragma GCC unroll 16
  for (int k = HB_STEP_ORDER - 1; k >= 0; --k) sum = HB_FMA(sum, u, coefficients[k]);
  return sum;
}

/* Returns what the tangent turns by. */
HB_INLINE HB_REAL hb_elastica_turn(const hb_elastica_field* f, HB_REAL h, hb_elastica_point* p) {
  hb_elastica_series at;
  HB_REAL x = p->c, y = p->s, cos = p->c, sin = p->s, turn;
  hb_elastica_expand(f, h, hb_elastica_curvature(f, p), p->c, p->s, &at);
  turn = at.rate[0];
#pragma GCC unroll 16
  for (int k = 0; k < HB_STEP_ORDER; ++k) {
    const HB_REAL next = HB_BROADCAST(1.0 / (k + 2));
    turn = HB_FMA(at.rate[k + 1], next, turn);
    cos += at.c[k + 1];
    sin += at.s[k + 1];
    x = HB_FMA(at.c[k + 1], next, x);
    y = HB_FMA(at.s[k + 1], next, y);
  }
  p->x = HB_FMA(x, h, p->x);
  p->y = HB_FMA(y, h, p->y);
  p->c = cos;
  p->s = sin;
  return turn;
}

HB_INLINE void hb_elastica_step(const hb_elastica_field* f, HB_REAL h, hb_elastica_point* p) {
  (void)hb_elastica_turn(f, h, p);
}

/* Moves p along the curve by h, forwards or back, and returns what the tangent turns by. A lane that has
 * arrived stays where it is, bit for bit, while others go on. */
HB_INLINE HB_REAL hb_elastica_move_turning(const hb_elastica_field* f, HB_REAL h, hb_elastica_point* p) {
  HB_REAL left = h, turn = HB_BROADCAST(0.0);
  do {
    const HB_REAL step = HB_MAX(HB_MIN(left, f->most_step), -f->most_step);
    left = left - step;
    turn += hb_elastica_turn(f, step, p);
  } while (HB_ANY(HB_ABS(left) > HB_BROADCAST(0.0)));
  return turn;
}

HB_INLINE void hb_elastica_move(const hb_elastica_field* f, HB_REAL h, hb_elastica_point* p) {
  (void)hb_elastica_move_turning(f, h, p);
}

#endif
