/* The lambda-residual of a cubic Bezier (elastica/bezier/lambda_residual.hpp) by 24 Gauss nodes and two
 * passes: moments and least squares first, then the residual itself, because differences of moments cancel.
 * What that errs by, and more nodes where it is too much: elastica/kernels/graded_residual.h.
 *
 * The curve is written in powers of u = t - 1/2, so that the nodes +u and -u share their even and odd halves
 * and moments of powers of u give those of x and y, and in a frame whose x axis joins two far control points,
 * which keeps the least squares well conditioned for nearly straight curves. The numerator of the curvature,
 * x'y'' - y'x'', is a quadratic in u. */
#ifndef HOTBLADE_ELASTICA_KERNELS_LAMBDA_RESIDUAL_H
#define HOTBLADE_ELASTICA_KERNELS_LAMBDA_RESIDUAL_H

#include "elastica/kernels/real.h"

#define HB_GAUSS_PAIRS 12

/* The positive nodes of the 24-point Gauss rule on [-1/2, 1/2]: u, its powers to the sixth, the weight. */
HB_CONSTANT double hb_gauss[HB_GAUSS_PAIRS][7] = {
    {0.4975936099985106801, 0.2475994007113499479, 0.1232038796334284338, 0.06130546323261964107,
     0.03050520676255017351, 0.01517919595672832163, 0.006170614899993599773},
    {0.4873642779856547491, 0.2375239394564785583, 0.1157606832575150445, 0.05641762181492489168,
     0.02749593352149859452, 0.01340053578824672393, 0.01426569431446683159},
    {0.4691372760013663793, 0.2200897837339822149, 0.103252321616690251, 0.04843951290407106234,
     0.02272478113464893424, 0.0106610419192364409, 0.02213871940870990308},
    {0.4432077635022005171, 0.1964331216286225048, 0.08706068451477751237, 0.03858597127276520248,
     0.01710160203036242294, 0.007579562788181620935, 0.02964929245771839037},
    {0.410000992986951461, 0.1681008142502862211, 0.06892150076453243115, 0.02825788375160923106,
     0.01158576039786962598, 0.004750173267635444491, 0.03667324070554015287},
    {0.3700620957892771821, 0.1369459547399521607, 0.05067850702093019406, 0.01875419451963702568,
     0.006940216528776654165, 0.002568311073870470973, 0.04309508076597663796},
    {0.3240468259684877846, 0.1050063454202514093, 0.03402697293998312272, 0.01102633257851715411,
     0.003573048074141415409, 0.001157834887458343678, 0.04880932605205694413},
    {0.2727107356944197678, 0.07437114536299167605, 0.02028180976637809527, 0.005531067262603238278,
     0.001508381422359849569, 0.0004113518073995498874, 0.05372213505798281739},
    {0.2168967538130225692, 0.04704420181462692043, 0.01020373465931728478, 0.002213156924375346833,
     0.0004800265525758258101, 0.0001041162009977528256, 0.05775283402686280068},
    {0.1575213398480816872, 0.02481297250753484762, 0.003908572675000504374, 0.0006156836046596801834,
     0.00009698330632848945202, 0.00001527694035576059839, 0.0608352364639016956},
    {0.09555943373680815458, 0.009131605376099428506, 0.0008726110388480544451, 0.00008338621674480798513,
     7.96833965358860123e-6, 7.61450025119480784e-7, 0.06291872817341414806},
    {0.03202844643130281304, 0.0010258213808028339, 0.00003285546514312864944, 1.05230950531223276e-6,
     3.370383862004360992e-8, 1.079481589771341685e-9, 0.06396909767337607849}};
#define HB_GAUSS_WEIGHT 6

/* Status codes, in the order of elastica/bezier/lambda_residual.hpp's ResidualStatus. */
#define HB_RESIDUAL_OK 0.0
#define HB_RESIDUAL_STRAIGHT 1.0
#define HB_RESIDUAL_CUSP 2.0
#define HB_RESIDUAL_NOT_FINITE 3.0

/* Shares of the frame's unit, the distance between two far control points. A control polygon flatter than the
 * first is a line up to the rounding of its coordinates; a speed below the second, at an end (zero edge) or
 * inside, makes Int kappa^2 ds diverge. */
#define HB_FLAT_SHARE 1e-13
#define HB_CUSP_SHARE 1e-9
/* Extents outside are no curve in double: squares vanish below, and overflow above. */
#define HB_LEAST_EXTENT 1e-140
#define HB_GREATEST_EXTENT 1e140

/* Control points p1, p2, p3 relative to p0. */
typedef struct {
  HB_REAL x1, y1, x2, y2, x3, y3;
} hb_legs;

/* x(u) = x1 u + x2 u^2 + x3 u^3 but for a constant, y alike; x'y'' - y'x'' = q0 + q1 u + q2 u^2. */
typedef struct {
  HB_REAL x1, x2, x3, y1, y2, y3, q0, q1, q2;
} hb_cubic;

/* What is known at every node: ds with the quadrature weight, 1/speed, curvature. */
typedef struct {
  HB_REAL ds[2 * HB_GAUSS_PAIRS], inverse[2 * HB_GAUSS_PAIRS], kappa[2 * HB_GAUSS_PAIRS];
} hb_nodes;

/* The sums over ds of u^j and kappa u^j, and of kappa^2. Those of x, y, x^2 .. follow by the powers of
 * x and y. */
typedef struct {
  HB_REAL m0, m1, m2, m3, m4, m5, m6, k0, k1, k2, k3, kk;
} hb_moments;

/* The fit kappa ~ one + x x + y y, and the same in powers of u. */
typedef struct {
  HB_REAL x, y, p0, p1, p2, p3;
} hb_affine;

/* |e - its true value| <= bound; both are 0 where the status is not HB_RESIDUAL_OK. */
typedef struct {
  HB_REAL e, bound, status;
} hb_residual;

HB_INLINE void hb_cubic_numerator(hb_cubic* c) {
  const HB_REAL two = HB_BROADCAST(2.0), six = HB_BROADCAST(6.0);
  c->q0 = two * (c->x1 * c->y2 - c->y1 * c->x2);
  c->q1 = six * (c->x1 * c->y3 - c->y1 * c->x3);
  c->q2 = six * (c->x2 * c->y3 - c->y2 * c->x3);
}

HB_INLINE hb_cubic hb_cubic_of_legs(const hb_legs* p) {
  const HB_REAL a = HB_BROADCAST(1.5), b = HB_BROADCAST(0.75), three = HB_BROADCAST(3.0);
  hb_cubic c;
  c.x1 = b * ((p->x3 + p->x2) - p->x1);
  c.y1 = b * ((p->y3 + p->y2) - p->y1);
  c.x2 = a * (p->x3 - (p->x1 + p->x2));
  c.y2 = a * (p->y3 - (p->y1 + p->y2));
  c.x3 = HB_FMA(three, p->x1 - p->x2, p->x3);
  c.y3 = HB_FMA(three, p->y1 - p->y2, p->y3);
  hb_cubic_numerator(&c);
  return c;
}

HB_INLINE HB_REAL hb_speed_squared(const hb_cubic* c, HB_REAL u) {
  const HB_REAL two_u = u + u, three_uu = HB_BROADCAST(3.0) * u * u;
  const HB_REAL dx = HB_FMA(three_uu, c->x3, HB_FMA(two_u, c->x2, c->x1));
  const HB_REAL dy = HB_FMA(three_uu, c->y3, HB_FMA(two_u, c->y2, c->y1));
  return HB_FMA(dx, dx, dy * dy);
}

/* The status: straight, cusp or neither. The speed at the ends is three edges' lengths; at a cusp the
 * numerator has a double root. */
HB_INLINE HB_REAL hb_residual_status(const hb_legs* p, const hb_cubic* c) {
  const HB_REAL one_half = HB_BROADCAST(0.5), flat = HB_BROADCAST(HB_FLAT_SHARE);
  const HB_REAL limit = HB_BROADCAST(HB_CUSP_SHARE * HB_CUSP_SHARE),
                edge_limit = HB_BROADCAST(1.0 / 9) * limit;
  const HB_REAL lx = p->x3 - p->x2, ly = p->y3 - p->y2;
  HB_REAL root = -c->q1 / (c->q2 + c->q2);
  root = HB_SELECT(root > one_half, one_half, root);
  root = HB_SELECT(root > -one_half, root, -one_half); /* 0/0 too */
  const HB_MASK cusp = (p->x1 * p->x1 + p->y1 * p->y1 < edge_limit) | (lx * lx + ly * ly < edge_limit) |
                       (hb_speed_squared(c, root) < limit);
  const HB_MASK straight = HB_MAX(HB_MAX(HB_ABS(p->y1), HB_ABS(p->y2)), HB_ABS(p->y3)) < flat;
  const HB_REAL status = HB_SELECT(cusp, HB_BROADCAST(HB_RESIDUAL_CUSP), HB_BROADCAST(HB_RESIDUAL_OK));
  return HB_SELECT(straight, HB_BROADCAST(HB_RESIDUAL_STRAIGHT), status);
}

HB_INLINE void hb_node_speed(HB_REAL weight, HB_REAL dx, HB_REAL dy, int i, hb_nodes* n) {
  const HB_REAL square = HB_FMA(dx, dx, dy * dy);
  const HB_REAL inverse = HB_RSQRT(square);
  n->inverse[i] = inverse;
  n->ds[i] = weight * (square * inverse);
}

HB_INLINE HB_REAL hb_node_curvature(HB_REAL numerator, int i, hb_nodes* n) {
  const HB_REAL inverse = n->inverse[i];
  return n->kappa[i] = (numerator * inverse) * (inverse * inverse);
}

HB_INLINE hb_moments hb_residual_moments(const hb_cubic* c, hb_nodes* n) {
  const HB_REAL zero = HB_BROADCAST(0.0);
  hb_moments m = {zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero};
  const HB_REAL three = HB_BROADCAST(3.0), dx2 = three * c->x3, dy2 = three * c->y3;
  const HB_REAL dx1 = c->x2 + c->x2, dy1 = c->y2 + c->y2;
  for (int i = 0; i < HB_GAUSS_PAIRS; ++i) {
    const HB_REAL u = HB_BROADCAST(hb_gauss[i][0]), uu = HB_BROADCAST(hb_gauss[i][1]);
    const HB_REAL w = HB_BROADCAST(hb_gauss[i][HB_GAUSS_WEIGHT]);
    const HB_REAL dx = HB_FMA(dx2, uu, c->x1), dy = HB_FMA(dy2, uu, c->y1);
    hb_node_speed(w, HB_FMA(dx1, u, dx), HB_FMA(dy1, u, dy), 2 * i, n);
    hb_node_speed(w, HB_FMA(-dx1, u, dx), HB_FMA(-dy1, u, dy), 2 * i + 1, n);
    const HB_REAL uuu = HB_BROADCAST(hb_gauss[i][2]);
    const HB_REAL q = HB_FMA(c->q2, uu, c->q0);
    const HB_REAL plus = hb_node_curvature(HB_FMA(c->q1, u, q), 2 * i, n);
    const HB_REAL minus = hb_node_curvature(HB_FMA(-c->q1, u, q), 2 * i + 1, n);
    const HB_REAL turn_plus = plus * n->ds[2 * i], turn_minus = minus * n->ds[2 * i + 1];
    const HB_REAL even = n->ds[2 * i] + n->ds[2 * i + 1], odd = n->ds[2 * i] - n->ds[2 * i + 1];
    const HB_REAL turn_even = turn_plus + turn_minus, turn_odd = turn_plus - turn_minus;
    m.m0 += even;
    m.m1 = HB_FMA(odd, u, m.m1);
    m.m2 = HB_FMA(even, uu, m.m2);
    m.m3 = HB_FMA(odd, uuu, m.m3);
    m.m4 = HB_FMA(even, HB_BROADCAST(hb_gauss[i][3]), m.m4);
    m.m5 = HB_FMA(odd, HB_BROADCAST(hb_gauss[i][4]), m.m5);
    m.m6 = HB_FMA(even, HB_BROADCAST(hb_gauss[i][5]), m.m6);
    m.k0 += turn_even;
    m.k1 = HB_FMA(turn_odd, u, m.k1);
    m.k2 = HB_FMA(turn_even, uu, m.k2);
    m.k3 = HB_FMA(turn_odd, uuu, m.k3);
    m.kk = HB_FMA(turn_plus, plus, HB_FMA(turn_minus, minus, m.kk));
  }
  return m;
}

HB_INLINE HB_REAL hb_dot(HB_REAL a1, HB_REAL a2, HB_REAL a3, HB_REAL b1, HB_REAL b2, HB_REAL b3) {
  return HB_FMA(a1, b1, HB_FMA(a2, b2, a3 * b3));
}

/* The least-squares fit of kappa by 1, x and y. A y that 1 and x explain to rounding is left out. */
HB_INLINE hb_affine hb_affine_of_moments(const hb_cubic* c, const hb_moments* m) {
  const HB_REAL per = HB_BROADCAST(1.0) / m->m0;
  const HB_REAL u1 = m->m1 * per, u2 = m->m2 * per, u3 = m->m3 * per, k0 = m->k0 * per;
  /* Central moments of u, u^2, u^3 and kappa. */
  const HB_REAL c11 = m->m2 - m->m1 * u1, c12 = m->m3 - m->m1 * u2, c13 = m->m4 - m->m1 * u3;
  const HB_REAL c22 = m->m4 - m->m2 * u2, c23 = m->m5 - m->m2 * u3, c33 = m->m6 - m->m3 * u3;
  const HB_REAL k1 = m->k1 - m->m1 * k0, k2 = m->k2 - m->m2 * k0, k3 = m->k3 - m->m3 * k0;
  const HB_REAL x1 = c->x1, x2 = c->x2, x3 = c->x3, y1 = c->y1, y2 = c->y2, y3 = c->y3;
  const HB_REAL v1 = hb_dot(c11, c12, c13, x1, x2, x3), w1 = hb_dot(c11, c12, c13, y1, y2, y3);
  const HB_REAL v2 = hb_dot(c12, c22, c23, x1, x2, x3), w2 = hb_dot(c12, c22, c23, y1, y2, y3);
  const HB_REAL v3 = hb_dot(c13, c23, c33, x1, x2, x3), w3 = hb_dot(c13, c23, c33, y1, y2, y3);
  const HB_REAL xx = hb_dot(v1, v2, v3, x1, x2, x3), xy = hb_dot(v1, v2, v3, y1, y2, y3);
  const HB_REAL yy = hb_dot(w1, w2, w3, y1, y2, y3);
  const HB_REAL kx = hb_dot(k1, k2, k3, x1, x2, x3), ky = hb_dot(k1, k2, k3, y1, y2, y3);
  const HB_REAL determinant = xx * yy - xy * xy;
  const HB_MASK dependent = determinant < HB_BROADCAST(1e-14) * (xx * yy);
  const HB_REAL share = HB_BROADCAST(1.0) / HB_SELECT(dependent, xx, determinant);
  hb_affine f;
  f.x = HB_SELECT(dependent, kx, kx * yy - ky * xy) * share;
  f.y = HB_SELECT(dependent, HB_BROADCAST(0.0), ky * xx - kx * xy) * share;
  f.p1 = HB_FMA(f.x, x1, f.y * y1);
  f.p2 = HB_FMA(f.x, x2, f.y * y2);
  f.p3 = HB_FMA(f.x, x3, f.y * y3);
  f.p0 = k0 - hb_dot(f.p1, f.p2, f.p3, u1, u2, u3);
  return f;
}

HB_INLINE HB_REAL hb_squared_misfit(const hb_nodes* n, const hb_affine* f) {
  HB_REAL plus = HB_BROADCAST(0.0), minus = HB_BROADCAST(0.0);
  for (int i = 0; i < HB_GAUSS_PAIRS; ++i) {
    const HB_REAL u = HB_BROADCAST(hb_gauss[i][0]), uu = HB_BROADCAST(hb_gauss[i][1]);
    const HB_REAL even = HB_FMA(f->p2, uu, f->p0), odd = HB_FMA(f->p3, uu, f->p1);
    const HB_REAL a = HB_FMA(-odd, u, n->kappa[2 * i] - even), b = HB_FMA(odd, u, n->kappa[2 * i + 1] - even);
    plus = HB_FMA(a * n->ds[2 * i], a, plus);
    minus = HB_FMA(b * n->ds[2 * i + 1], b, minus);
  }
  return plus + minus;
}

HB_INLINE HB_REAL hb_root_share(HB_REAL misfit, HB_REAL total) {
  const HB_REAL share = misfit / total, one = HB_BROADCAST(1.0);
  return HB_SQRT(HB_SELECT(share > one, one, share));
}

/* Puts the legs into a frame of unit size whose x axis points at the farthest control point. Returns
 * HB_RESIDUAL_CUSP or HB_RESIDUAL_NOT_FINITE where there is none, else HB_RESIDUAL_OK. */
HB_INLINE HB_REAL hb_unit_frame(hb_legs* p) {
  const HB_REAL x1 = p->x1, y1 = p->y1, x2 = p->x2, y2 = p->y2, x3 = p->x3, y3 = p->y3;
  const HB_REAL r1 = x1 * x1 + y1 * y1, r2 = x2 * x2 + y2 * y2, r3 = x3 * x3 + y3 * y3;
  const HB_MASK second = r2 > r1;
  const HB_REAL r12 = HB_SELECT(second, r2, r1), ax12 = HB_SELECT(second, x2, x1),
                ay12 = HB_SELECT(second, y2, y1);
  const HB_MASK third = r3 >= r12;
  const HB_REAL r = HB_SELECT(third, r3, r12), per = HB_BROADCAST(1.0) / r;
  const HB_REAL ax = HB_SELECT(third, x3, ax12) * per, ay = HB_SELECT(third, y3, ay12) * per;
  const HB_MASK point = r < HB_BROADCAST(HB_LEAST_EXTENT * HB_LEAST_EXTENT);
  /* A comparison drops NaN; a sum keeps it. */
  const HB_MASK finite = r1 + r2 + r3 < HB_BROADCAST(HB_GREATEST_EXTENT * HB_GREATEST_EXTENT);
  const HB_REAL status = HB_SELECT(point, HB_BROADCAST(HB_RESIDUAL_CUSP), HB_BROADCAST(HB_RESIDUAL_OK));
  p->x1 = x1 * ax + y1 * ay;
  p->y1 = y1 * ax - x1 * ay;
  p->x2 = x2 * ax + y2 * ay;
  p->y2 = y2 * ax - x2 * ay;
  p->x3 = x3 * ax + y3 * ay;
  p->y3 = y3 * ax - x3 * ay;
  return HB_SELECT(finite, status, HB_BROADCAST(HB_RESIDUAL_NOT_FINITE));
}

#endif
