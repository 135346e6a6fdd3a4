/* Sine and cosine by polynomials, for |a| up to 1e6: within 1 unit in the last place or so, no branches. */
#ifndef HOTBLADE_ELASTICA_KERNELS_SINCOS_H
#define HOTBLADE_ELASTICA_KERNELS_SINCOS_H

#include "elastica/kernels/real.h"

typedef struct {
  HB_REAL sin, cos;
} hb_sincos;

/* The nearest integer of |a| < 2^51, by the rounding of an addition. */
HB_INLINE HB_REAL hb_round(HB_REAL a) {
  const HB_REAL magic = HB_BROADCAST(6755399441055744.0); /* 1.5 * 2^52 */
  return (a + magic) - magic;
}

/* Sine and cosine on [-pi/4, pi/4], by Chebyshev fits of (sin a / a - 1) / a^2 and
 * (cos a - 1 + a^2/2) / a^4 in a^2, errors 2e-17 and 2e-18. */
HB_INLINE hb_sincos hb_sincos_reduced(HB_REAL a) {
  const HB_REAL z = a * a;
  HB_REAL s = HB_BROADCAST(1.5918115263265975194e-10);
  HB_REAL c = HB_BROADCAST(-1.1382623647474604629e-11);
  hb_sincos r;
  s = HB_FMA(s, z, HB_BROADCAST(-2.505113165023518147e-8));
  c = HB_FMA(c, z, HB_BROADCAST(2.0876146146558611582e-9));
  s = HB_FMA(s, z, HB_BROADCAST(2.7557316101617874437e-6));
  c = HB_FMA(c, z, HB_BROADCAST(-2.7557317271145145962e-7));
  s = HB_FMA(s, z, HB_BROADCAST(-0.00019841269836756772528));
  c = HB_FMA(c, z, HB_BROADCAST(0.000024801587298764560771));
  s = HB_FMA(s, z, HB_BROADCAST(0.0083333333333309472945));
  c = HB_FMA(c, z, HB_BROADCAST(-0.0013888888888887396492));
  s = HB_FMA(s, z, HB_BROADCAST(-0.16666666666666664622));
  c = HB_FMA(c, z, HB_BROADCAST(0.041666666666666665388));
  r.sin = HB_FMA(s * z, a, a);
  r.cos = HB_FMA(c * z, z, HB_FMA(HB_BROADCAST(-0.5), z, HB_BROADCAST(1.0)));
  return r;
}

/* Quarter turns are taken off in three parts of pi/2, the first two short enough for exact products. */
HB_INLINE hb_sincos hb_sincos_of(HB_REAL a) {
  const HB_REAL n = hb_round(a * HB_BROADCAST(0.63661977236758134308));
  HB_REAL reduced = HB_FMA(n, HB_BROADCAST(-0x1.921fb544p+0), a);
  reduced = HB_FMA(n, HB_BROADCAST(-0x1.0b4611a0p-34), reduced);
  reduced = HB_FMA(n, HB_BROADCAST(-0x1.898cc51701b84p-64), reduced);
  const hb_sincos r = hb_sincos_reduced(reduced);
  /* Quarter m in {-2, -1, 0, 1, 2}: odd ones swap, and the signs follow. */
  const HB_REAL m = HB_FMA(HB_BROADCAST(-4.0), hb_round(n * HB_BROADCAST(0.25)), n);
  const HB_REAL absolute = HB_ABS(m);
  const HB_REAL one = HB_BROADCAST(1.0), one_half = HB_BROADCAST(0.5);
  const HB_MASK odd = HB_ABS(absolute - one) < one_half;
  const HB_REAL s = HB_SELECT(odd, r.cos, r.sin), c = HB_SELECT(odd, r.sin, r.cos);
  const HB_MASK sin_negative = (absolute > one + one_half) | ((m < -one_half) & odd);
  const HB_MASK cos_negative = (absolute > one + one_half) | ((m > one_half) & odd);
  hb_sincos out;
  out.sin = HB_SELECT(sin_negative, -s, s);
  out.cos = HB_SELECT(cos_negative, -c, c);
  return out;
}

#endif
