/* Jacobi's elliptic functions sn, cn, dn and the integral of dn^2 (or cn^2) by a descending Landen ladder
 * that is made once per modulus (elastica/curve/closed_form.hpp) and climbed by every sample: at the bottom, where
 * the modulus vanishes to rounding, they are sine and cosine. One division a level, no branches. */
#ifndef HOTBLADE_ELASTICA_KERNELS_JACOBI_H
#define HOTBLADE_ELASTICA_KERNELS_JACOBI_H

#include "elastica/kernels/sincos.h"

#define HB_LADDER_LEVELS 20

/* Modulus k[n] and weight z[n] of levels 1 .. levels, the topmost first. An argument v of the top is bottom v
 * at the bottom; the integral is linear v + sum of z[n] sn_n cn_(n-1). |v| is cut at `reach` (modulus 1 alone
 * has one: beyond it nothing moves). */
typedef struct {
  int levels;
  double bottom, linear, reach;
  double k[HB_LADDER_LEVELS], z[HB_LADDER_LEVELS];
} hb_ladder;

/* `wave` is the integral without its linear part. */
typedef struct {
  HB_REAL v, sn, cn, dn, wave;
} hb_jacobi;

/* The functions of an argument at the bottom of the ladder. */
HB_INLINE hb_jacobi hb_jacobi_bottom(const hb_ladder* ladder, HB_REAL argument) {
  const HB_REAL reach = HB_BROADCAST(ladder->reach);
  hb_jacobi j;
  j.v = HB_SELECT(argument > reach, reach, HB_SELECT(argument < -reach, -reach, argument));
  const hb_sincos bottom = hb_sincos_of(HB_BROADCAST(ladder->bottom) * j.v);
  j.sn = bottom.sin;
  j.cn = bottom.cos;
  j.dn = HB_BROADCAST(1.0);
  j.wave = HB_BROADCAST(0.0);
  return j;
}

HB_INLINE void hb_jacobi_step(HB_REAL k, HB_REAL z, hb_jacobi* j) {
  const HB_REAL one = HB_BROADCAST(1.0), ks = k * j->sn, q = ks * j->sn, share = HB_RECIPROCAL(one + q);
  j->cn = (j->cn * j->dn) * share;
  j->wave = HB_FMA(z * j->sn, j->cn, j->wave);
  j->sn = (j->sn + ks) * share;
  j->dn = (one - q) * share;
}

/* Climbs all levels for `count` arguments side by side: one's steps are a chain of dependent operations. */
HB_INLINE void hb_jacobi_climb(const hb_ladder* ladder, hb_jacobi* j, int count) {
  for (int n = ladder->levels - 1; n >= 0; --n) {
    const HB_REAL k = HB_BROADCAST(ladder->k[n]), z = HB_BROADCAST(ladder->z[n]);
    for (int i = 0; i < count; ++i) hb_jacobi_step(k, z, j + i);
  }
}

HB_INLINE hb_jacobi hb_jacobi_at(const hb_ladder* ladder, HB_REAL argument) {
  hb_jacobi j = hb_jacobi_bottom(ladder, argument);
  hb_jacobi_climb(ladder, &j, 1);
  return j;
}

/* sn, cn, dn and Int dn^2 of modulus k at u, from the ladder's own: above 1 it is the ladder of the
 * reciprocal modulus 1/k at v = k u, with the integral of cn^2 (elastica/curve/closed_form.hpp). */
HB_INLINE hb_jacobi hb_jacobi_of_modulus(const hb_ladder* ladder, double k, const hb_jacobi* j) {
  const HB_REAL per = HB_BROADCAST(k > 1 ? 1 / k : 1.0);
  hb_jacobi out;
  out.v = per * j->v;
  out.wave = per * HB_FMA(HB_BROADCAST(ladder->linear), j->v, j->wave);
  out.sn = per * j->sn;
  out.cn = k > 1 ? j->dn : j->cn;
  out.dn = k > 1 ? j->cn : j->dn;
  return out;
}

/* A curve in closed form: argument rate s + phase; (drift v + 2 wave, rise) scaled, less its start, turned by
 * (cos, sin) and moved to (x, y). `wide` is 1 without inflections (the reciprocal modulus), else 0. */
typedef struct {
  double rate, phase, scale, drift, x, y, cos, sin, modulus, start_x, start_y, curvature;
  int wide;
} hb_closed_form;

typedef struct {
  HB_REAL x, y, tangent_x, tangent_y, kappa;
} hb_curve_point;

HB_INLINE HB_REAL hb_closed_form_argument(const hb_closed_form* c, HB_REAL s) {
  return HB_FMA(HB_BROADCAST(c->rate), s, HB_BROADCAST(c->phase));
}

/* The point of argument v, whose functions are j. */
HB_INLINE hb_curve_point hb_closed_form_point(const hb_closed_form* c, HB_REAL v, const hb_jacobi* at) {
  const HB_REAL one = HB_BROADCAST(1.0), two = HB_BROADCAST(2.0), k = HB_BROADCAST(c->modulus);
  const hb_jacobi j = *at;
  /* sin and cos of half the tangent's angle against the axis. */
  const HB_REAL half_sin = c->wide ? j.sn : k * j.sn, half_cos = c->wide ? j.cn : j.dn;
  const HB_REAL across = c->wide ? two * j.sn * j.sn / (one + j.dn) : -two * k * j.cn;
  /* Beyond the reach of modulus 1 the curve runs on along its axis, backwards. */
  const HB_REAL along = HB_FMA(HB_BROADCAST(c->drift), j.v, two * j.wave) - (v - j.v);
  const HB_REAL x = HB_BROADCAST(c->scale) * (along - HB_BROADCAST(c->start_x));
  const HB_REAL y = HB_BROADCAST(c->scale) * (across - HB_BROADCAST(c->start_y));
  const HB_REAL tx = HB_FMA(-two * half_sin, half_sin, one), ty = two * (half_sin * half_cos);
  const HB_REAL turn_x = HB_BROADCAST(c->cos), turn_y = HB_BROADCAST(c->sin);
  hb_curve_point p;
  p.x = HB_BROADCAST(c->x) + (x * turn_x - y * turn_y);
  p.y = HB_BROADCAST(c->y) + (x * turn_y + y * turn_x);
  p.tangent_x = tx * turn_x - ty * turn_y;
  p.tangent_y = tx * turn_y + ty * turn_x;
  p.kappa = HB_BROADCAST(c->curvature) * (c->wide ? j.dn : j.cn);
  return p;
}

HB_INLINE hb_curve_point hb_closed_form_at(const hb_ladder* ladder, const hb_closed_form* c, HB_REAL s) {
  const HB_REAL v = hb_closed_form_argument(c, s);
  const hb_jacobi j = hb_jacobi_at(ladder, v);
  return hb_closed_form_point(c, v, &j);
}

#endif
