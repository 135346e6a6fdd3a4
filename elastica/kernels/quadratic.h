/* Quadratic Bezier curves: length, bending energy, parabola, arc-length inverse, nearest point.
 *
 * The common subset of C99, C++ and OpenCL C 1.2, so that host and device run the same formulas. HB_REAL is a
 * scalar here, double unless defined before. Never compile with reassociating or relaxed mathematics: the
 * edges carry exact tails.
 *
 * Notation: d0 = b1 - b0, d1 = b2 - b1, D = d1 - d0, e = (d0 + d1)/2, cross = d0 x d1. Half the velocity is
 * e + v D with v = t - 1/2. With u = v + m, m = e.D/|D|^2 and h = |cross|/|D|^2 the half speed is |D|
 * sqrt(u^2 + h^2), from which every integral below follows (docs/arcs.md). Sources: Ahn, Hoffmann, Rosen,
 * Geometric constraints on quadratic Bezier curves using minimal length and energy; "Quadratic Bezier is a
 * parabola" (docs/arcs.md). Differs from the papers: forms without cancellation near straight, folded and
 * uniform curves.
 *
 * Any length unit; coordinate differences between 1e-60 and 1e60 in double, so that fifth powers neither
 * overflow nor vanish. */
#ifndef HOTBLADE_ELASTICA_KERNELS_QUADRATIC_H
#define HOTBLADE_ELASTICA_KERNELS_QUADRATIC_H

#ifndef __OPENCL_VERSION__
#include <math.h>
#endif

#include "elastica/kernels/real.h"

/* The edges of a control polygon, each correct to rounding however the points lie. */
typedef struct {
  HB_REAL d0x, d0y, d1x, d1y; /* b1 - b0, b2 - b1 */
  HB_REAL ddx, ddy;           /* D = d1 - d0 */
  HB_REAL ex, ey;             /* e = (b2 - b0)/2 */
  HB_REAL cross;              /* d0 x d1, twice the signed area */
} hb_quadratic_edges;

/* The curve as p = origin + scale (x X + x^2 Y), x from x0 (t = 0) to x1 (t = 1); Y is the axis, X is Y
 * turned by -90 degrees. degenerate: 1 when the control points are collinear, and then only axis and origin
 * (the turning point of the fold) mean anything; 2 when D = 0. */
typedef struct {
  HB_REAL origin_x, origin_y, axis_x, axis_y, scale, x0, x1;
  int degenerate;
} hb_parabola;

typedef struct {
  HB_REAL t, x, y, distance_sq;
} hb_quadratic_nearest_point;

/* a - b = difference + the value returned, exactly. */
static inline HB_REAL hb_difference_tail(HB_REAL a, HB_REAL b, HB_REAL difference) {
  const HB_REAL back = difference - a;
  return (a - (difference - back)) - (b + back);
}

static inline hb_quadratic_edges hb_quadratic_edges_of(HB_REAL b0x, HB_REAL b0y, HB_REAL b1x, HB_REAL b1y,
                                                       HB_REAL b2x, HB_REAL b2y) {
  hb_quadratic_edges q;
  HB_REAL t0x, t0y, t1x, t1y, p, r, lead, tail;
  q.d0x = b1x - b0x;
  q.d0y = b1y - b0y;
  q.d1x = b2x - b1x;
  q.d1y = b2y - b1y;
  t0x = hb_difference_tail(b1x, b0x, q.d0x);
  t0y = hb_difference_tail(b1y, b0y, q.d0y);
  t1x = hb_difference_tail(b2x, b1x, q.d1x);
  t1y = hb_difference_tail(b2y, b1y, q.d1y);
  q.ddx = q.d1x - q.d0x;
  q.ddy = q.d1y - q.d0y;
  q.ddx += hb_difference_tail(q.d1x, q.d0x, q.ddx) + (t1x - t0x);
  q.ddy += hb_difference_tail(q.d1y, q.d0y, q.ddy) + (t1y - t0y);
  q.ex = (b2x - b0x) / 2;
  q.ey = (b2y - b0y) / 2;
  /* The determinant with every first-order tail: correct to rounding unless the angle is below 1e-30. */
  p = q.d0x * q.d1y;
  r = q.d0y * q.d1x;
  lead = p - r;
  tail = hb_difference_tail(p, r, lead) + (fma(q.d0x, q.d1y, -p) - fma(q.d0y, q.d1x, -r));
  tail += (t0x * q.d1y + q.d0x * t1y) - (t0y * q.d1x + q.d0y * t1x);
  q.cross = lead + (tail + (t0x * t1y - t0y * t1x));
  return q;
}

/* The sum of |e + v D| over a pair of Gauss nodes at +-v. */
static inline HB_REAL hb_half_speed_pair(HB_REAL ex, HB_REAL ey, HB_REAL ddx, HB_REAL ddy, HB_REAL v) {
  const HB_REAL ax = ex + v * ddx, ay = ey + v * ddy, bx = ex - v * ddx, by = ey - v * ddy;
  return sqrt(ax * ax + ay * ay) + sqrt(bx * bx + by * by);
}

/* 2 Int |e + v D| dv over [-1/2, 1/2]. Where |e| >= 2|D| the integrand's nearest singularity is four half
 * widths from the middle and 10 Gauss nodes leave 8^-20 = 1e-18; the closed form, which would cancel there,
 * serves the rest. */
static inline HB_REAL hb_quadratic_length_core(HB_REAL ex, HB_REAL ey, HB_REAL ddx, HB_REAL ddy,
                                               HB_REAL cross) {
  const HB_REAL a = ddx * ddx + ddy * ddy;
  if (ex * ex + ey * ey >= 4 * a) {
    return (HB_REAL)0.2955242247147528701738930 *
               hb_half_speed_pair(ex, ey, ddx, ddy, (HB_REAL)0.0744371694908156054885108) +
           (HB_REAL)0.2692667193099963550912269 *
               hb_half_speed_pair(ex, ey, ddx, ddy, (HB_REAL)0.2166976970646235953957121) +
           (HB_REAL)0.2190863625159820439955349 *
               hb_half_speed_pair(ex, ey, ddx, ddy, (HB_REAL)0.3397047841495122031171388) +
           (HB_REAL)0.1494513491505805931457763 *
               hb_half_speed_pair(ex, ey, ddx, ddy, (HB_REAL)0.4325316833444922553421486) +
           (HB_REAL)0.0666713443086881375935688 *
               hb_half_speed_pair(ex, ey, ddx, ddy, (HB_REAL)0.4869532642585858600418204);
  } else {
    const HB_REAL g = sqrt(a), m = fabs(ex * ddx + ey * ddy) / a, h = fabs(cross) / a;
    const HB_REAL u1 = m + (HB_REAL)0.5, u0 = m - (HB_REAL)0.5;
    const HB_REAL w1 = sqrt(u1 * u1 + h * h), w0 = sqrt(u0 * u0 + h * h);
    HB_REAL sum = u1 * w1 - u0 * w0;
    if (h > (HB_REAL)1e-18) { /* below, h^2 log h is lost in the sum */
      sum += h * h * (u0 >= 0 ? log((u1 + w1) / (u0 + w0)) : log((u1 + w1) / h * ((w0 - u0) / h)));
    }
    return g * sum;
  }
}

/* Arc length of the whole curve (paper, equation 3). */
static inline HB_REAL hb_quadratic_length(hb_quadratic_edges q) {
  return hb_quadratic_length_core(q.ex, q.ey, q.ddx, q.ddy, q.cross);
}

/* Arc length from t = 0 to t in [0, 1]: the length of the part, whose edges are t d0 and t (d0 + t D). */
static inline HB_REAL hb_quadratic_length_to(hb_quadratic_edges q, HB_REAL t) {
  const HB_REAL s = t * t;
  return hb_quadratic_length_core(t * q.d0x + s / 2 * q.ddx, t * q.d0y + s / 2 * q.ddy, s * q.ddx, s * q.ddy,
                                  s * t * q.cross);
}

/* The parameter at arc length s, clamped to [0, length]: Newton, kept in its bracket. The length to it is s
 * to rounding; at the turning point of a fold t itself is only good to the root of that. */
static inline HB_REAL hb_quadratic_parameter_at(hb_quadratic_edges q, HB_REAL s) {
  const HB_REAL length = hb_quadratic_length(q);
  HB_REAL lo = 0, hi = 1, t;
  int i;
  if (!(s > 0)) return 0;
  if (s >= length) return 1;
  t = s / length;
  for (i = 0; i < 80; ++i) {
    const HB_REAL excess = hb_quadratic_length_to(q, t) - s;
    const HB_REAL vx = q.d0x + t * q.ddx, vy = q.d0y + t * q.ddy;
    HB_REAL next;
    if (excess > 0) {
      hi = t;
    } else {
      lo = t;
    }
    if (fabs(excess) <= (HB_REAL)1e-16 * length) return t;
    next = t - excess / (2 * sqrt(vx * vx + vy * vy));
    if (!(next > lo && next < hi)) next = (lo + hi) / 2;
    if (next == t) return t;
    t = next;
  }
  return t;
}

/* 1/2 Int kappa^2 ds (paper, equation 4). 0 for a straight curve, infinite for one that folds back on itself.
 */
static inline HB_REAL hb_quadratic_energy(hb_quadratic_edges q) {
  const HB_REAL a = q.ddx * q.ddx + q.ddy * q.ddy, g = sqrt(a);
  const HB_REAL a0 = q.d0x * q.ddx + q.d0y * q.ddy, a1 = q.d1x * q.ddx + q.d1y * q.ddy;
  const HB_REAL n0 = q.d0x * q.d0x + q.d0y * q.d0y, n1 = q.d1x * q.d1x + q.d1y * q.d1y;
  const HB_REAL x2 = q.cross * q.cross;
  if (a0 >= 0 ||
      a1 <= 0) { /* the vertex of the parabola is outside: with sin(angle) = s, s0 and s1 of one sign */
    if (q.cross == 0) {
      return 0;
    } else {
      const HB_REAL r0 = sqrt(n0), r1 = sqrt(n1), s0 = fabs(a0) / (r0 * g), s1 = fabs(a1) / (r1 * g);
      const HB_REAL f0 = 1 / (n0 * (1 + s0)), f1 = 1 / (n1 * (1 + s1));
      const HB_REAL mean = (s0 * r0 + s1 * r1) / (s0 + s1);
      return x2 / 4 * mean / (n0 * n1) * (f0 + f1 - x2 / a * (f0 * f0 + f0 * f1 + f1 * f1) / 3);
    }
  } else {
    /* |u| at the ends: from its own edge where that is short, where the vertex may be next to the end; from m
     * where the edges are long, which keeps the sum at 1. */
    const HB_REAL m = (q.ex * q.ddx + q.ey * q.ddy) / a;
    const HB_REAL u0 = n0 < a ? -a0 / a : (HB_REAL)0.5 - m, u1 = n1 < a ? a1 / a : (HB_REAL)0.5 + m;
    const HB_REAL s0 = fmin(u0 * g / sqrt(n0), (HB_REAL)1), s1 = fmin(u1 * g / sqrt(n1), (HB_REAL)1);
    return a * g / (4 * x2) * (s0 + s1 - (s0 * s0 * s0 + s1 * s1 * s1) / 3);
  }
}

static inline hb_parabola hb_quadratic_parabola(HB_REAL b0x, HB_REAL b0y, HB_REAL b1x, HB_REAL b1y,
                                                HB_REAL b2x, HB_REAL b2y) {
  const hb_quadratic_edges q = hb_quadratic_edges_of(b0x, b0y, b1x, b1y, b2x, b2y);
  const HB_REAL a = q.ddx * q.ddx + q.ddy * q.ddy;
  hb_parabola p = {b0x, b0y, 0, 0, 0, 0, 0, 2};
  if (a > 0) {
    const HB_REAL g = sqrt(a), m = (q.ex * q.ddx + q.ey * q.ddy) / a, h = q.cross / a, t = (HB_REAL)0.5 - m;
    p.origin_x = b0x + t * (2 * q.d0x + t * q.ddx);
    p.origin_y = b0y + t * (2 * q.d0y + t * q.ddy);
    p.axis_x = q.ddx / g;
    p.axis_y = q.ddy / g;
    p.scale = 4 * h * h * g;
    p.degenerate = !(p.scale > 0);
    if (!p.degenerate) {
      p.x0 = (m - (HB_REAL)0.5) / (2 * h);
      p.x1 = (m + (HB_REAL)0.5) / (2 * h);
    }
  }
  return p;
}

/* The root of c3 v^3 + c2 v^2 + c1 v + c0 in [lo, hi], on which it rises from below 0 to above. Newton from
 * `start`: monotone where the piece is convex and start is at hi, or concave and start is at lo; from an
 * inflection the first step crosses the root and the rest is monotone. */
static inline HB_REAL hb_rising_root(HB_REAL c3, HB_REAL c2, HB_REAL c1, HB_REAL c0, HB_REAL lo, HB_REAL hi,
                                     HB_REAL start) {
  HB_REAL v = start;
  int i;
  for (i = 0; i < 64; ++i) {
    const HB_REAL f = ((c3 * v + c2) * v + c1) * v + c0, slope = (3 * c3 * v + 2 * c2) * v + c1;
    HB_REAL next = slope > 0 ? v - f / slope : (f > 0 ? lo : hi);
    next = fmin(fmax(next, lo), hi);
    if (fabs(next - v) <= (HB_REAL)1e-16) return next;
    v = next;
  }
  return v;
}

static inline hb_quadratic_nearest_point hb_nearer_at(hb_quadratic_nearest_point best, HB_REAL v, HB_REAL cx,
                                                      HB_REAL cy, HB_REAL ex, HB_REAL ey, HB_REAL ddx,
                                                      HB_REAL ddy) {
  const HB_REAL x = cx + v * (2 * ex + v * ddx), y = cy + v * (2 * ey + v * ddy), sq = x * x + y * y;
  if (sq < best.distance_sq) {
    best.t = v + (HB_REAL)0.5;
    best.x = x;
    best.y = y;
    best.distance_sq = sq;
  }
  return best;
}

/* The point of the curve nearest to p, the first one of equals; every degenerate curve too. The distance's
 * derivative is the cubic (c + 2 v e + v^2 D).(e + v D), c = q(1/2) - p; in the parabola's frame it reads 2
 * X^3 + (1 - 2 q_y) X - q_x = 0. Only its rising roots are minima: at most one on either side. */
static inline hb_quadratic_nearest_point hb_quadratic_nearest(HB_REAL b0x, HB_REAL b0y, HB_REAL b1x,
                                                              HB_REAL b1y, HB_REAL b2x, HB_REAL b2y,
                                                              HB_REAL px, HB_REAL py) {
  const HB_REAL ddx = (b2x - b1x) - (b1x - b0x), ddy = (b2y - b1y) - (b1y - b0y);
  const HB_REAL ex = (b2x - b0x) / 2, ey = (b2y - b0y) / 2;
  const HB_REAL rx = b0x - px, ry = b0y - py, sx = b2x - px, sy = b2y - py;
  const HB_REAL cx = (rx + sx) / 2 - ddx / 4, cy = (ry + sy) / 2 - ddy / 4;
  const HB_REAL c3 = ddx * ddx + ddy * ddy, c2 = 3 * (ex * ddx + ey * ddy);
  const HB_REAL c1 = 2 * (ex * ex + ey * ey) + cx * ddx + cy * ddy, c0 = cx * ex + cy * ey;
  const HB_REAL lo = (HB_REAL)-0.5, hi = (HB_REAL)0.5;
  const HB_REAL f_lo = ((c3 * lo + c2) * lo + c1) * lo + c0, f_hi = ((c3 * hi + c2) * hi + c1) * hi + c0;
  const HB_REAL disc = c2 * c2 - 3 * c3 * c1;
  hb_quadratic_nearest_point best;
  best.t = 0;
  best.x = rx;
  best.y = ry;
  best.distance_sq = rx * rx + ry * ry;
  if (!(disc > 0)) {
    if (f_lo < 0 && f_hi > 0) {
      const HB_REAL bend = c3 > 0 ? fmin(fmax(-c2 / (3 * c3), lo), hi) : 0;
      best = hb_nearer_at(best, hb_rising_root(c3, c2, c1, c0, lo, hi, bend), cx, cy, ex, ey, ddx, ddy);
    }
  } else {
    const HB_REAL root = sqrt(disc), k = c2 >= 0 ? -c2 - root : -c2 + root;
    const HB_REAL one = k / (3 * c3), two = c1 / k;
    const HB_REAL first = fmin(fmin(one, two), hi), last = fmax(fmax(one, two), lo);
    if (first > lo && f_lo < 0 && ((c3 * first + c2) * first + c1) * first + c0 >= 0) {
      best = hb_nearer_at(best, hb_rising_root(c3, c2, c1, c0, lo, first, lo), cx, cy, ex, ey, ddx, ddy);
    }
    if (last < hi && f_hi > 0 && ((c3 * last + c2) * last + c1) * last + c0 <= 0) {
      best = hb_nearer_at(best, hb_rising_root(c3, c2, c1, c0, last, hi, hi), cx, cy, ex, ey, ddx, ddy);
    }
  }
  if (sx * sx + sy * sy < best.distance_sq) {
    best.t = 1;
    best.x = sx;
    best.y = sy;
    best.distance_sq = sx * sx + sy * sy;
  }
  best.x += px;
  best.y += py;
  return best;
}

#endif
