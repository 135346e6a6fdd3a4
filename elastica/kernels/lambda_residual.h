/* The lambda-residual of a cubic Bezier (elastica/lambda_residual.hpp) by 24 Gauss nodes and two passes:
 * moments and least squares first, then the residual itself, because differences of moments cancel.
 *
 * The curve is written in powers of u = t - 1/2 about its mean, so that the nodes +u and -u share their even
 * and odd halves, and in a frame whose x axis joins two far control points, which keeps the least squares
 * well conditioned for nearly straight curves. The numerator of the curvature, x'y'' - y'x'', is a quadratic
 * in u. */
#ifndef HOTBLADE_ELASTICA_KERNELS_LAMBDA_RESIDUAL_H
#define HOTBLADE_ELASTICA_KERNELS_LAMBDA_RESIDUAL_H

#include "elastica/kernels/real.h"

#define HB_GAUSS_PAIRS 12

/* Positive nodes u and weights of the 24-point Gauss rule on [-1/2, 1/2]. */
HB_CONSTANT double hb_gauss_u[HB_GAUSS_PAIRS] = {
    0.49759360999851068009, 0.4873642779856547491,  0.46913727600136637926,  0.44320776350220051711,
    0.41000099298695146098, 0.37006209578927718212, 0.32404682596848778463,  0.27271073569441976783,
    0.21689675381302256924, 0.15752133984808168719, 0.095559433736808154579, 0.032028446431302813043};
HB_CONSTANT double hb_gauss_w[HB_GAUSS_PAIRS] = {
    0.0061706148999935997734, 0.014265694314466831591, 0.022138719408709903084, 0.029649292457718390373,
    0.036673240705540152867,  0.043095080765976637959, 0.048809326052056944135, 0.053722135057982817391,
    0.057752834026862800677,  0.060835236463901695602, 0.062918728173414148061, 0.063969097673376078487};

/* Status codes, in the order of elastica/lambda_residual.hpp's ResidualStatus. */
#define HB_RESIDUAL_OK 0.0
#define HB_RESIDUAL_STRAIGHT 1.0
#define HB_RESIDUAL_CUSP 2.0
#define HB_RESIDUAL_NOT_FINITE 3.0

/* Shares of the frame's unit, the distance between two far control points. A control polygon flatter than the
 * first is a line up to the rounding of its coordinates; a speed below the second, at an end (zero edge) or
 * inside, makes Int kappa^2 ds diverge. */
#define HB_FLAT_SHARE 1e-13
#define HB_CUSP_SHARE 1e-9
/* Extents outside are no curve in double: below, squares vanish; above (and for NaN), differences overflow.
 */
#define HB_LEAST_EXTENT 1e-290
#define HB_GREATEST_EXTENT 1e290

/* Control points p1, p2, p3 relative to p0. */
typedef struct {
  HB_REAL x1, y1, x2, y2, x3, y3;
} hb_legs;

/* x(u) = x0 + x1 u + x2 u^2 + x3 u^3, y alike; x'y'' - y'x'' = q0 + q1 u + q2 u^2. */
typedef struct {
  HB_REAL x0, x1, x2, x3, y0, y1, y2, y3, q0, q1, q2;
} hb_cubic;

/* At one node: ds with the quadrature weight, 1/speed, curvature, position. */
typedef struct {
  HB_REAL ds[2 * HB_GAUSS_PAIRS], inverse[2 * HB_GAUSS_PAIRS], kappa[2 * HB_GAUSS_PAIRS];
  HB_REAL x[2 * HB_GAUSS_PAIRS], y[2 * HB_GAUSS_PAIRS];
} hb_nodes;

/* Sums over ds of the products named. */
typedef struct {
  HB_REAL s, x, y, k, xx, xy, yy, kx, ky, kk;
} hb_moments;

/* kappa ~ one + x x + y y. */
typedef struct {
  HB_REAL one, x, y;
} hb_affine;

typedef struct {
  HB_REAL e, status;
} hb_residual;

HB_INLINE void hb_cubic_numerator(hb_cubic* c) {
  const HB_REAL two = HB_BROADCAST(2.0), six = HB_BROADCAST(6.0);
  c->q0 = two * (c->x1 * c->y2 - c->y1 * c->x2);
  c->q1 = six * (c->x1 * c->y3 - c->y1 * c->x3);
  c->q2 = six * (c->x2 * c->y3 - c->y2 * c->x3);
}

HB_INLINE hb_cubic hb_cubic_of_legs(const hb_legs* p) {
  const HB_REAL a = HB_BROADCAST(1.5), b = HB_BROADCAST(0.75), three = HB_BROADCAST(3.0);
  const HB_REAL twelfth = HB_BROADCAST(-1.0 / 12);
  hb_cubic c;
  c.x1 = b * ((p->x3 + p->x2) - p->x1);
  c.y1 = b * ((p->y3 + p->y2) - p->y1);
  c.x2 = a * (p->x3 - (p->x1 + p->x2));
  c.y2 = a * (p->y3 - (p->y1 + p->y2));
  c.x3 = HB_FMA(three, p->x1 - p->x2, p->x3);
  c.y3 = HB_FMA(three, p->y1 - p->y2, p->y3);
  c.x0 = twelfth * c.x2; /* the mean over u is 0 */
  c.y0 = twelfth * c.y2;
  hb_cubic_numerator(&c);
  return c;
}

HB_INLINE HB_REAL hb_speed_squared(const hb_cubic* c, HB_REAL u) {
  const HB_REAL two_u = u + u, three_uu = HB_BROADCAST(3.0) * u * u;
  const HB_REAL dx = HB_FMA(three_uu, c->x3, HB_FMA(two_u, c->x2, c->x1));
  const HB_REAL dy = HB_FMA(three_uu, c->y3, HB_FMA(two_u, c->y2, c->y1));
  return HB_FMA(dx, dx, dy * dy);
}

/* Straight, cusp or neither. At a cusp the numerator has a double root, so the speed is looked at there and
 * at the two ends. */
HB_INLINE HB_REAL hb_residual_status(const hb_legs* p, const hb_cubic* c) {
  const HB_REAL half = HB_BROADCAST(0.5), flat = HB_BROADCAST(HB_FLAT_SHARE);
  HB_REAL root = -c->q1 / (c->q2 + c->q2);
  root = HB_SELECT(root > half, half, root);
  root = HB_SELECT(root > -half, root, -half); /* 0/0 too */
  const HB_REAL limit = HB_BROADCAST(HB_CUSP_SHARE * HB_CUSP_SHARE);
  const HB_MASK cusp = (hb_speed_squared(c, half) < limit) | (hb_speed_squared(c, -half) < limit) |
                       (hb_speed_squared(c, root) < limit);
  const HB_MASK straight = (HB_ABS(p->y1) < flat) & (HB_ABS(p->y2) < flat) & (HB_ABS(p->y3) < flat);
  const HB_REAL status = HB_SELECT(cusp, HB_BROADCAST(HB_RESIDUAL_CUSP), HB_BROADCAST(HB_RESIDUAL_OK));
  return HB_SELECT(straight, HB_BROADCAST(HB_RESIDUAL_STRAIGHT), status);
}

HB_INLINE void hb_node(HB_REAL weight, HB_REAL dx, HB_REAL dy, HB_REAL numerator, HB_REAL x, HB_REAL y, int i,
                       hb_nodes* n, hb_moments* m) {
  const HB_REAL square = HB_FMA(dx, dx, dy * dy);
  const HB_REAL inverse = HB_RSQRT(square);
  const HB_REAL per_square = inverse * inverse;
  const HB_REAL ds = weight * (square * inverse);
  const HB_REAL turn = (weight * numerator) * per_square; /* kappa ds */
  const HB_REAL kappa = (numerator * inverse) * per_square;
  const HB_REAL xs = x * ds, ys = y * ds;
  n->ds[i] = ds;
  n->inverse[i] = inverse;
  n->kappa[i] = kappa;
  n->x[i] = x;
  n->y[i] = y;
  m->s += ds;
  m->x += xs;
  m->y += ys;
  m->k += turn;
  m->xx = HB_FMA(xs, x, m->xx);
  m->xy = HB_FMA(xs, y, m->xy);
  m->yy = HB_FMA(ys, y, m->yy);
  m->kx = HB_FMA(turn, x, m->kx);
  m->ky = HB_FMA(turn, y, m->ky);
  m->kk = HB_FMA(turn, kappa, m->kk);
}

HB_INLINE hb_moments hb_residual_moments(const hb_cubic* c, hb_nodes* n) {
  const HB_REAL zero = HB_BROADCAST(0.0), three = HB_BROADCAST(3.0);
  const HB_REAL dx2 = three * c->x3, dy2 = three * c->y3, dx1 = c->x2 + c->x2, dy1 = c->y2 + c->y2;
  hb_moments m = {zero, zero, zero, zero, zero, zero, zero, zero, zero, zero};
  for (int i = 0; i < HB_GAUSS_PAIRS; ++i) {
    const HB_REAL u = HB_BROADCAST(hb_gauss_u[i]), uu = HB_BROADCAST(hb_gauss_u[i] * hb_gauss_u[i]);
    const HB_REAL w = HB_BROADCAST(hb_gauss_w[i]), v = -u;
    const HB_REAL dx = HB_FMA(dx2, uu, c->x1), dy = HB_FMA(dy2, uu, c->y1), q = HB_FMA(c->q2, uu, c->q0);
    const HB_REAL x_even = HB_FMA(c->x2, uu, c->x0), x_odd = HB_FMA(c->x3, uu, c->x1);
    const HB_REAL y_even = HB_FMA(c->y2, uu, c->y0), y_odd = HB_FMA(c->y3, uu, c->y1);
    hb_node(w, HB_FMA(dx1, u, dx), HB_FMA(dy1, u, dy), HB_FMA(c->q1, u, q), HB_FMA(x_odd, u, x_even),
            HB_FMA(y_odd, u, y_even), 2 * i, n, &m);
    hb_node(w, HB_FMA(dx1, v, dx), HB_FMA(dy1, v, dy), HB_FMA(c->q1, v, q), HB_FMA(x_odd, v, x_even),
            HB_FMA(y_odd, v, y_even), 2 * i + 1, n, &m);
  }
  return m;
}

/* Least squares of kappa by 1, x and y. A y that 1 and x explain to rounding is left out. */
HB_INLINE hb_affine hb_affine_of_moments(const hb_moments* m) {
  const HB_REAL per_length = HB_BROADCAST(1.0) / m->s;
  const HB_REAL x = m->x * per_length, y = m->y * per_length, k = m->k * per_length;
  const HB_REAL xx = m->xx - m->x * x, xy = m->xy - m->x * y, yy = m->yy - m->y * y;
  const HB_REAL kx = m->kx - m->k * x, ky = m->ky - m->k * y;
  const HB_REAL per_xx = HB_BROADCAST(1.0) / xx;
  const HB_REAL left = yy - xy * (xy * per_xx);
  const HB_MASK dependent = left < HB_BROADCAST(1e-14) * yy;
  hb_affine f;
  f.y = HB_SELECT(dependent, HB_BROADCAST(0.0), (ky - kx * (xy * per_xx)) / left);
  f.x = (kx - f.y * xy) * per_xx;
  f.one = k - (f.x * x + f.y * y);
  return f;
}

HB_INLINE HB_REAL hb_squared_misfit(const hb_nodes* n, const hb_affine* f) {
  HB_REAL even = HB_BROADCAST(0.0), odd = HB_BROADCAST(0.0);
  for (int i = 0; i < 2 * HB_GAUSS_PAIRS; i += 2) {
    const HB_REAL a = HB_FMA(-f->y, n->y[i], HB_FMA(-f->x, n->x[i], n->kappa[i] - f->one));
    const HB_REAL b = HB_FMA(-f->y, n->y[i + 1], HB_FMA(-f->x, n->x[i + 1], n->kappa[i + 1] - f->one));
    even = HB_FMA(a * n->ds[i], a, even);
    odd = HB_FMA(b * n->ds[i + 1], b, odd);
  }
  return even + odd;
}

HB_INLINE HB_REAL hb_root_share(HB_REAL misfit, HB_REAL total) {
  const HB_REAL share = misfit / total, one = HB_BROADCAST(1.0);
  return HB_SQRT(HB_SELECT(share > one, one, share));
}

HB_INLINE hb_residual hb_residual_or_zero(HB_REAL e, HB_REAL status) {
  hb_residual r;
  r.status = status;
  r.e = HB_SELECT(status > HB_BROADCAST(0.5), HB_BROADCAST(0.0), e);
  return r;
}

/* Legs in a frame of unit size whose x axis points at the farthest control point; status HB_RESIDUAL_CUSP or
 * HB_RESIDUAL_NOT_FINITE where there is none, else HB_RESIDUAL_OK. */
HB_INLINE HB_REAL hb_unit_frame(hb_legs* p) {
  const HB_REAL extent =
      HB_MAX(HB_MAX(HB_MAX(HB_ABS(p->x1), HB_ABS(p->y1)), HB_MAX(HB_ABS(p->x2), HB_ABS(p->y2))),
             HB_MAX(HB_ABS(p->x3), HB_ABS(p->y3)));
  /* A comparison drops NaN; a sum keeps it. */
  const HB_REAL sum =
      HB_ABS(p->x1) + HB_ABS(p->y1) + HB_ABS(p->x2) + HB_ABS(p->y2) + HB_ABS(p->x3) + HB_ABS(p->y3);
  const HB_MASK point = extent < HB_BROADCAST(HB_LEAST_EXTENT);
  const HB_MASK finite = sum < HB_BROADCAST(HB_GREATEST_EXTENT);
  const HB_REAL scale = HB_BROADCAST(1.0) / extent;
  const HB_REAL x1 = p->x1 * scale, y1 = p->y1 * scale, x2 = p->x2 * scale, y2 = p->y2 * scale;
  const HB_REAL x3 = p->x3 * scale, y3 = p->y3 * scale;
  const HB_REAL r1 = x1 * x1 + y1 * y1, r2 = x2 * x2 + y2 * y2, r3 = x3 * x3 + y3 * y3;
  const HB_MASK second = r2 > r1;
  const HB_REAL r12 = HB_SELECT(second, r2, r1), ax12 = HB_SELECT(second, x2, x1),
                ay12 = HB_SELECT(second, y2, y1);
  const HB_MASK third = r3 >= r12;
  const HB_REAL per = HB_BROADCAST(1.0) / HB_SELECT(third, r3, r12);
  const HB_REAL ax = HB_SELECT(third, x3, ax12) * per, ay = HB_SELECT(third, y3, ay12) * per;
  const HB_REAL status = HB_SELECT(point, HB_BROADCAST(HB_RESIDUAL_CUSP), HB_BROADCAST(HB_RESIDUAL_OK));
  p->x1 = x1 * ax + y1 * ay;
  p->y1 = y1 * ax - x1 * ay;
  p->x2 = x2 * ax + y2 * ay;
  p->y2 = y2 * ax - x2 * ay;
  p->x3 = x3 * ax + y3 * ay;
  p->y3 = y3 * ax - x3 * ay;
  return HB_SELECT(finite, status, HB_BROADCAST(HB_RESIDUAL_NOT_FINITE));
}

/* e and status of a curve in a unit frame. */
HB_INLINE hb_residual hb_lambda_residual_in_frame(const hb_legs* p, HB_REAL frame_status) {
  const hb_cubic c = hb_cubic_of_legs(p);
  const HB_REAL shape = hb_residual_status(p, &c);
  const HB_REAL status = HB_SELECT(frame_status > HB_BROADCAST(0.5), frame_status, shape);
  hb_nodes n;
  const hb_moments m = hb_residual_moments(&c, &n);
  const hb_affine f = hb_affine_of_moments(&m);
  return hb_residual_or_zero(hb_root_share(hb_squared_misfit(&n, &f), m.kk), status);
}

/* e and status of the Bezier whose control points, relative to the first, are p. */
HB_INLINE hb_residual hb_lambda_residual(const hb_legs* legs) {
  hb_legs p = *legs;
  const HB_REAL frame_status = hb_unit_frame(&p);
  return hb_lambda_residual_in_frame(&p, frame_status);
}

#endif
