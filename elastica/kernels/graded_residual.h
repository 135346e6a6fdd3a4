/* The error bound of the lambda-residual's quadrature, and the quadrature on panels graded towards
 * near-cusps.
 *
 * A cubic's derivative, x' + i y', is a quadratic P(u) with two complex roots, and the speed squared is P
 * times its conjugate: ds, kappa ds and kappa^2 ds are analytic but at these roots and their mirror images. A
 * Gauss rule of n nodes on [-1, 1] errs by (1 / 2 pi i) times the integral of f k_n around the interval, with
 * k_n ~ 2 pi phi^-(2n+1), phi = w + sqrt(w^2 - 1) (Donaldson, Elliott, "A unified approach to quadrature
 * rules with asymptotic estimates of their remainders", SIAM J. Numer. Anal. 9, 1972). So the error is known
 * before a node is added: by the ellipse with foci -1 and 1 through a root, and by the root's strength. Where
 * it is too large the interval is cut into panels, each of which has all roots outside an ellipse of fixed
 * proportions. */
#ifndef HOTBLADE_ELASTICA_KERNELS_GRADED_RESIDUAL_H
#define HOTBLADE_ELASTICA_KERNELS_GRADED_RESIDUAL_H

#include "elastica/kernels/lambda_residual.h"

/* Half the sum of a root's distances from a panel's ends, in half panels: phi is 2.26, and phi^-49 is 5e-18.
 */
#define HB_PANEL_REACH 1.35
/* A panel away from a root grows to seven times the distance it starts at, and a root that is no cusp leaves
 * at least 1e-10: two roots are passed in 60. */
#define HB_MOST_PANELS 96
/* A bound above this is brought down by panels: below it no digit that anybody writes is touched. */
#define HB_GRADE_ABOVE 1e-9
/* The largest error seen on curves of every kind was an eighth of the bound (LambdaResidualBound.*). */
#define HB_QUADRATURE_SAFETY 4.0
/* What 24 nodes leave of e^2 on panels, by the same formula. */
#define HB_GRADED_SHARE 1e-13
#define HB_ROOT_OF_GRADED_SHARE 3.2e-7
/* Rounding of the legs, of the numerator and of the speed: three times the largest seen on 1e5 curves. */
#define HB_ROUNDING_SHARE 1e-13

/* The zeros of x' + i y' by u, with y >= 0: the mirrored ones count as well. */
typedef struct {
  HB_REAL x1, y1, x2, y2;
  HB_REAL lead2, gap2; /* squares of the leading coefficient, and of P' at either root */
} hb_speed_roots;

/* Reciprocal root, root and reciprocal of a positive number, about or exactly. */
HB_INLINE HB_REAL hb_rsqrt_of(HB_REAL a, int about) {
  /* NOLINTNEXTLINE(bugprone-branch-clone): one and the same where a type knows no quicker root */
  return about ? HB_ABOUT_RSQRT(a) : HB_RSQRT(a);
}

HB_INLINE HB_REAL hb_root_of(HB_REAL a, int about) {
  return about ? a * HB_ABOUT_RSQRT(a) : HB_SQRT(a);
}

HB_INLINE HB_REAL hb_reciprocal_of(HB_REAL a, int about) {
  const HB_REAL r = hb_rsqrt_of(a, about);
  return about ? r * r : HB_RECIPROCAL(a);
}

/* The roots about, for the bound, or exactly, for panels. Least values keep numbers that vanish in range. The
 * derivative of a parabola lacks its first coefficient and has one root at infinity: a million is as far. */
HB_INLINE hb_speed_roots hb_speed_roots_of(const hb_cubic* c, int about) {
  const HB_REAL three = HB_BROADCAST(3.0), zero = HB_BROADCAST(0.0), one_half = HB_BROADCAST(0.5);
  const HB_REAL least = HB_BROADCAST(1e-30), least_lead = HB_BROADCAST(1e-24);
  /* a u^2 + 2 b u + d; s = sqrt(b^2 - a d). */
  const HB_REAL ax = three * c->x3, ay = three * c->y3, bx = c->x2, by = c->y2, dx = c->x1, dy = c->y1;
  const HB_REAL ex = (bx * bx - by * by) - (ax * dx - ay * dy);
  const HB_REAL ey = HB_BROADCAST(2.0) * bx * by - (ax * dy + ay * dx);
  const HB_REAL size = hb_root_of(HB_MAX(HB_FMA(ex, ex, ey * ey), least), about);
  const HB_REAL large = hb_root_of(one_half * (size + HB_ABS(ex)), about);
  const HB_REAL small = one_half * ey * hb_reciprocal_of(large, about);
  const HB_MASK flat = ex > zero;
  HB_REAL sx = HB_SELECT(flat, large, HB_ABS(small));
  HB_REAL sy = HB_SELECT(flat, small, HB_SELECT(ey < zero, -large, large));
  const HB_MASK against = HB_FMA(bx, sx, by * sy) < zero;
  sx = HB_SELECT(against, -sx, sx);
  sy = HB_SELECT(against, -sy, sy);
  const HB_REAL qx = -(bx + sx), qy = -(by + sy);
  hb_speed_roots r;
  r.gap2 = HB_BROADCAST(4.0) * size;
  const HB_REAL lead2 = HB_FMA(ax, ax, ay * ay), far = HB_BROADCAST(1e6);
  const HB_MASK parabola = lead2 < least_lead;
  r.lead2 = HB_MAX(lead2, least_lead);
  const HB_REAL per1 = hb_reciprocal_of(r.lead2, about);
  const HB_REAL per2 = hb_reciprocal_of(HB_MAX(HB_FMA(qx, qx, qy * qy), least), about);
  r.x1 = HB_SELECT(parabola, far, (qx * ax + qy * ay) * per1);
  r.y1 = HB_SELECT(parabola, far, HB_ABS(qy * ax - qx * ay) * per1);
  r.x2 = (dx * qx + dy * qy) * per2;
  r.y2 = HB_ABS(dy * qx - dx * qy) * per2;
  return r;
}

/* An ellipse with foci -1/2 and 1/2 through a root. */
typedef struct {
  HB_REAL q;       /* (phi^2 + phi^-2) / 2 */
  HB_REAL product; /* of the root's distances from both ends */
  HB_REAL size;    /* |z|^2 */
} hb_root_ellipse;

HB_INLINE hb_root_ellipse hb_root_ellipse_of(HB_REAL x, HB_REAL y) {
  const HB_REAL farthest = HB_BROADCAST(1e12), one_half = HB_BROADCAST(0.5);
  const HB_REAL left = x + one_half, right = x - one_half, yy = y * y;
  const HB_REAL from = HB_MIN(HB_FMA(left, left, yy), farthest);
  const HB_REAL to = HB_MIN(HB_FMA(right, right, yy), farthest);
  hb_root_ellipse r;
  r.size = HB_MIN(HB_FMA(x, x, yy), farthest);
  r.product = hb_root_of(HB_MAX(from * to, HB_BROADCAST(1e-30)), 1);
  r.q = HB_BROADCAST(4.0) * (r.size + r.product);
  return r;
}

/* What the roots do to the 24-node rule on [-1/2, 1/2], whatever the fit is. */
typedef struct {
  HB_REAL spike;           /* error of the integral of kappa^2 ds */
  HB_REAL decay, wide, z2; /* for those of the fit */
} hb_rule_error;

/* z: the root with the smaller ellipse, counted twice; y: the smaller of both imaginary parts. With phi^-49
 * for k_n and k_n' / k_n = 1 / r, where r = g^(1/2) / 49 and g is the product of the root's distances from
 * both ends, the error of S (u - z)^(-5/2) and its mirror image is 4 pi S phi^-49 r^(-3/2) / Gamma(5/2). Near
 * the root kappa^2 ds has S = 1 / (4 sqrt(|P'| |conj P|)), 2 kappa q ds has residue q, where q is the fit,
 * and q^2 ds has |q|^2 sqrt(|P'| |conj P|) (u - z)^(1/2). Distances below r count as r: these roots act as
 * one. Where a power asks for a root of g, something below it stands in the first, something above it in the
 * others. */
HB_INLINE hb_rule_error hb_rule_error_of(const hb_speed_roots* r) {
  const hb_root_ellipse a = hb_root_ellipse_of(r->x1, r->y1), b = hb_root_ellipse_of(r->x2, r->y2);
  const HB_MASK first = a.q < b.q;
  const HB_REAL one = HB_BROADCAST(1.0), least = HB_BROADCAST(1e-30);
  const HB_REAL farthest = HB_BROADCAST(1e5), per = HB_BROADCAST(1.0 / 49);
  const HB_REAL q = HB_SELECT(first, a.q, b.q), y = HB_MIN(r->y1, r->y2);
  const HB_REAL g = HB_MIN(HB_SELECT(first, a.product, b.product), farthest);
  /* phi^-48 stands for phi^-49, and 1e-120 for what is below it. */
  const HB_REAL p2 = q - hb_root_of(HB_MAX(HB_FMA(q, q, -one), least), 1);
  const HB_REAL p = HB_MAX(p2, HB_BROADCAST(1e-5)), pp = p * p, p4 = pp * pp, p8 = p4 * p4, p16 = p8 * p8;
  const HB_REAL low = HB_MIN(g, one), high = HB_MAX(g, one) * per, rr = g * (per * per);
  const HB_REAL others = HB_MAX(r->gap2, r->lead2 * rr) * rr, mirror = HB_MIN(y + y, farthest);
  const HB_REAL strength2 = others * (HB_MAX(mirror, low * per) * (low * per));
  hb_rule_error error;
  error.decay = p16 * p8;
  error.spike = HB_BROADCAST(4.8) * error.decay * HB_ABOUT_RSQRT(HB_MAX(strength2, least));
  error.wide = others * ((mirror + high) * high);
  error.z2 = HB_MIN(HB_SELECT(first, a.size, b.size), farthest);
  return error;
}

/* The errors of the integrals of 2 kappa q ds and q^2 ds. */
HB_INLINE HB_REAL hb_fit_error(const hb_rule_error* rule, const hb_affine* f) {
  /* |z| is at most (1 + |z|^2) / 2. */
  const HB_REAL one_half = HB_BROADCAST(0.5), z = HB_FMA(one_half, rule->z2, one_half);
  const HB_REAL odd = HB_FMA(HB_ABS(f->p3), rule->z2, HB_ABS(f->p1));
  const HB_REAL fit = HB_FMA(odd, z, HB_FMA(HB_ABS(f->p2), rule->z2, HB_ABS(f->p0)));
  return rule->decay * fit * HB_FMA(rule->wide, fit * fit * HB_BROADCAST(4.0), HB_BROADCAST(29.2));
}

HB_INLINE HB_REAL hb_flatness(const hb_legs* p) {
  return HB_MAX(HB_MAX(HB_ABS(p->y1), HB_ABS(p->y2)), HB_ABS(p->y3));
}

HB_INLINE HB_REAL hb_width(const hb_legs* p) {
  return HB_MAX(HB_MAX(HB_ABS(p->x1), HB_ABS(p->x2)), HB_ABS(p->x3));
}

/* What rounding of the coordinates does to e: a polygon as flat as f has a curvature known to 1e-16 / f of
 * itself. */
HB_INLINE HB_REAL hb_rounding_bound(const hb_legs* p) {
  return HB_BROADCAST(HB_ROUNDING_SHARE) *
         (HB_BROADCAST(1.0) + hb_width(p) / HB_MAX(hb_flatness(p), HB_BROADCAST(1e-100)));
}

/* The bound of e by the 24-node rule, kk being its sum of kappa^2. A spike stretches kappa and its misfit
 * alike, so that e^2 moves by 1 - e^2 of it, to first order; a thousandth is for the others. */
HB_INLINE HB_REAL hb_residual_bound(const hb_legs* p, const hb_rule_error* rule, const hb_affine* f,
                                    HB_REAL kk, HB_REAL e) {
  const HB_REAL moved = HB_MAX(HB_FMA(-e, e, HB_BROADCAST(1.0)), HB_BROADCAST(1e-3));
  const HB_REAL error =
      HB_BROADCAST(HB_QUADRATURE_SAFETY) * HB_FMA(rule->spike, moved, hb_fit_error(rule, f));
  /* |e - e'| is |e^2 - e'^2| / (e + e'), or at most e + e'. Both quotients over one: error / (kk least) and
   * wide / flat. */
  const HB_REAL least = HB_BROADCAST(1e-10), over = kk * HB_MAX(e, least);
  const HB_REAL flat = HB_MAX(hb_flatness(p), HB_BROADCAST(1e-100)),
                wide = HB_BROADCAST(HB_ROUNDING_SHARE) * hb_width(p);
  const HB_REAL sum = HB_FMA(error, flat, wide * over) * HB_RECIPROCAL(over * flat);
  return sum + HB_SELECT(e < least, least, HB_BROADCAST(HB_ROUNDING_SHARE));
}

/* The longest panel from `from` that keeps one root outside its ellipse: (x, y) is the root. */
HB_INLINE HB_REAL hb_panel_of_root(HB_REAL x, HB_REAL y, HB_REAL from) {
  const HB_REAL along = x - from, reach = HB_BROADCAST(HB_PANEL_REACH);
  const HB_REAL distance = HB_SQRT(HB_FMA(along, along, y * y));
  return HB_BROADCAST(2.0 / (HB_PANEL_REACH * HB_PANEL_REACH - 1)) * HB_FMA(reach, distance, -along);
}

/* Where the panel from `from` ends. */
HB_INLINE HB_REAL hb_panel_end(const hb_speed_roots* r, HB_REAL from) {
  const HB_REAL end = HB_BROADCAST(0.5), left = end - from;
  const HB_REAL length = HB_MIN(hb_panel_of_root(r->x1, r->y1, from), hb_panel_of_root(r->x2, r->y2, from));
  return HB_SELECT(length < left, from + length, end);
}

typedef struct {
  HB_REAL u, ds, inverse, kappa;
} hb_node;

HB_INLINE hb_node hb_node_at(const hb_cubic* c, HB_REAL u, HB_REAL weight) {
  const HB_REAL two_u = u + u, three_uu = HB_BROADCAST(3.0) * (u * u);
  const HB_REAL dx = HB_FMA(three_uu, c->x3, HB_FMA(two_u, c->x2, c->x1));
  const HB_REAL dy = HB_FMA(three_uu, c->y3, HB_FMA(two_u, c->y2, c->y1));
  const HB_REAL square = HB_FMA(dx, dx, dy * dy);
  hb_node n;
  n.u = u;
  n.inverse = HB_RSQRT(square);
  n.ds = weight * (square * n.inverse);
  n.kappa = HB_FMA(HB_FMA(c->q2, u, c->q1), u, c->q0) * n.inverse * (n.inverse * n.inverse);
  return n;
}

HB_INLINE void hb_add_moments(hb_moments* m, const hb_node* n) {
  const HB_REAL u = n->u, uu = u * u, uuu = uu * u, turn = n->kappa * n->ds;
  m->m0 += n->ds;
  m->m1 = HB_FMA(n->ds, u, m->m1);
  m->m2 = HB_FMA(n->ds, uu, m->m2);
  m->m3 = HB_FMA(n->ds, uuu, m->m3);
  m->m4 = HB_FMA(n->ds, uu * uu, m->m4);
  m->m5 = HB_FMA(n->ds, uu * uuu, m->m5);
  m->m6 = HB_FMA(n->ds, uuu * uuu, m->m6);
  m->k0 += turn;
  m->k1 = HB_FMA(turn, u, m->k1);
  m->k2 = HB_FMA(turn, uu, m->k2);
  m->k3 = HB_FMA(turn, uuu, m->k3);
  m->kk = HB_FMA(turn, n->kappa, m->kk);
}

/* The node of pair i at the side `sign` of the panel from `from` to `to`. */
HB_INLINE hb_node hb_panel_node(const hb_cubic* c, HB_REAL from, HB_REAL to, int i, double sign) {
  const HB_REAL length = to - from;
  const HB_REAL middle = HB_FMA(HB_BROADCAST(0.5), length, from);
  return hb_node_at(c, HB_FMA(HB_BROADCAST(sign * hb_gauss[i][0]), length, middle),
                    HB_BROADCAST(hb_gauss[i][HB_GAUSS_WEIGHT]) * length);
}

HB_INLINE hb_moments hb_graded_moments(const hb_cubic* c, const hb_speed_roots* r, HB_REAL* reached) {
  const HB_REAL zero = HB_BROADCAST(0.0), end = HB_BROADCAST(0.5);
  hb_moments m = {zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero};
  HB_REAL from = -end;
  for (int k = 0; k < HB_MOST_PANELS && HB_ANY(from < end); ++k) {
    const HB_REAL to = hb_panel_end(r, from);
    for (int i = 0; i < HB_GAUSS_PAIRS; ++i) {
      const hb_node minus = hb_panel_node(c, from, to, i, -1.0), plus = hb_panel_node(c, from, to, i, 1.0);
      hb_add_moments(&m, &minus);
      hb_add_moments(&m, &plus);
    }
    from = to;
  }
  *reached = from;
  return m;
}

HB_INLINE HB_REAL hb_fit_misfit(const hb_affine* f, const hb_node* n) {
  return n->kappa - HB_FMA(HB_FMA(HB_FMA(f->p3, n->u, f->p2), n->u, f->p1), n->u, f->p0);
}

HB_INLINE HB_REAL hb_graded_misfit(const hb_cubic* c, const hb_speed_roots* r, const hb_affine* f) {
  const HB_REAL end = HB_BROADCAST(0.5);
  HB_REAL from = -end, sum = HB_BROADCAST(0.0);
  for (int k = 0; k < HB_MOST_PANELS && HB_ANY(from < end); ++k) {
    const HB_REAL to = hb_panel_end(r, from);
    for (int i = 0; i < HB_GAUSS_PAIRS; ++i) {
      const hb_node minus = hb_panel_node(c, from, to, i, -1.0), plus = hb_panel_node(c, from, to, i, 1.0);
      const HB_REAL a = hb_fit_misfit(f, &minus), b = hb_fit_misfit(f, &plus);
      sum = HB_FMA(a * minus.ds, a, sum);
      sum = HB_FMA(b * plus.ds, b, sum);
    }
    from = to;
  }
  return sum;
}

/* The least speed on the curve, squared: near a root or at an end. */
HB_INLINE HB_REAL hb_least_speed2(const hb_cubic* c, const hb_speed_roots* r) {
  const HB_REAL end = HB_BROADCAST(0.5);
  const HB_REAL a = HB_MAX(HB_MIN(r->x1, end), -end), b = HB_MAX(HB_MIN(r->x2, end), -end);
  return HB_MIN(HB_MIN(hb_speed_squared(c, a), hb_speed_squared(c, b)),
                HB_MIN(hb_speed_squared(c, end), hb_speed_squared(c, -end)));
}

/* Bound of e by graded panels. A speed as small as v is known to 1e-16 / v of itself; where that counts,
 * kappa is all spike, and e, which is near 1, moves by sqrt(1 - e^2) of it. */
HB_INLINE HB_REAL hb_graded_bound(const hb_legs* p, HB_REAL least_speed2, HB_REAL e) {
  const HB_REAL one = HB_BROADCAST(1.0), rest = HB_MAX(HB_FMA(-e, e, one), HB_BROADCAST(0.0));
  const HB_REAL blur = HB_BROADCAST(HB_ROUNDING_SHARE) / HB_SQRT(HB_MAX(least_speed2, HB_BROADCAST(1e-40)));
  return HB_BROADCAST(HB_GRADED_SHARE) / HB_MAX(e, HB_BROADCAST(HB_ROOT_OF_GRADED_SHARE)) +
         hb_rounding_bound(p) + blur * (HB_SQRT(rest) + blur);
}

/* Where all panels did not reach the end, or a number overflowed, nothing is known: the bound is 1. */
HB_INLINE hb_residual hb_residual_or_zero(HB_REAL e, HB_REAL bound, HB_REAL status) {
  const HB_REAL zero = HB_BROADCAST(0.0);
  const HB_MASK none = status > HB_BROADCAST(0.5);
  hb_residual r;
  r.status = status;
  r.e = HB_SELECT(none, zero, HB_MAX(e, zero));
  r.bound = HB_SELECT(none, zero, HB_MIN(bound, HB_BROADCAST(1.0)));
  return r;
}

HB_INLINE HB_REAL hb_status_of(const hb_legs* p, const hb_cubic* c, HB_REAL frame_status) {
  const HB_REAL shape = hb_residual_status(p, c);
  return HB_SELECT(frame_status > HB_BROADCAST(0.5), frame_status, shape);
}

/* A near-cusp that the numerator's double root did not tell, being nearly straight, is told by its speed. */
HB_INLINE HB_REAL hb_status_of_speed(HB_REAL status, HB_REAL least_speed2) {
  const HB_MASK cusp = least_speed2 < HB_BROADCAST(HB_CUSP_SHARE * HB_CUSP_SHARE);
  const HB_REAL slow = HB_SELECT(cusp, HB_BROADCAST(HB_RESIDUAL_CUSP), status);
  return HB_SELECT(status > HB_BROADCAST(0.5), status, slow);
}

/* Whether 24 nodes are too few. */
HB_INLINE HB_MASK hb_wants_panels(HB_REAL bound, HB_REAL status) {
  const HB_MASK sure = bound <= HB_BROADCAST(HB_GRADE_ABOVE), ok = status < HB_BROADCAST(0.5);
  return HB_NOT(sure) & ok;
}

/* e, its bound and status by 24 nodes, of a curve in a unit frame. */
HB_INLINE hb_residual hb_plain_residual(const hb_legs* p, HB_REAL frame_status) {
  const hb_cubic c = hb_cubic_of_legs(p);
  hb_nodes n;
  const hb_moments m = hb_residual_moments(&c, &n);
  const hb_affine f = hb_affine_of_moments(&c, &m);
  const HB_REAL e = hb_root_share(hb_squared_misfit(&n, &f), m.kk);
  const hb_speed_roots roots = hb_speed_roots_of(&c, 1);
  const hb_rule_error rule = hb_rule_error_of(&roots);
  return hb_residual_or_zero(e, hb_residual_bound(p, &rule, &f, m.kk, e), hb_status_of(p, &c, frame_status));
}

/* The same by graded panels. */
HB_INLINE hb_residual hb_graded_residual(const hb_legs* p, HB_REAL frame_status) {
  const hb_cubic c = hb_cubic_of_legs(p);
  const hb_speed_roots r = hb_speed_roots_of(&c, 0);
  HB_REAL reached;
  const hb_moments m = hb_graded_moments(&c, &r, &reached);
  const hb_affine f = hb_affine_of_moments(&c, &m);
  const HB_REAL e = hb_root_share(hb_graded_misfit(&c, &r, &f), m.kk), slowest = hb_least_speed2(&c, &r);
  const HB_REAL bound = hb_graded_bound(p, slowest, e);
  return hb_residual_or_zero(e, HB_SELECT(reached < HB_BROADCAST(0.5), HB_BROADCAST(1.0), bound),
                             hb_status_of_speed(hb_status_of(p, &c, frame_status), slowest));
}

/* e, its bound and status of the Bezier whose control points, relative to the first, are p; one lane. */
HB_INLINE hb_residual hb_lambda_residual(const hb_legs* legs) {
  hb_legs p = *legs;
  const HB_REAL frame_status = hb_unit_frame(&p);
  const hb_residual plain = hb_plain_residual(&p, frame_status);
  if (!HB_ANY(hb_wants_panels(plain.bound, plain.status))) return plain;
  return hb_graded_residual(&p, frame_status);
}

#endif
