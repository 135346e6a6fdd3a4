/* The lambda-residual of a curve in standard position, ends (0, 0) and (1, 0), as a function of its two end
 * edges, and its gradient by their lengths.
 *
 * With e^2 = R / K, R being a minimum over the affine fit, only the explicit dependence of R on the lengths
 * counts (envelope theorem): de = (dR - e^2 dK) / (2 e K). */
#ifndef HOTBLADE_ELASTICA_KERNELS_EDGE_RESIDUAL_H
#define HOTBLADE_ELASTICA_KERNELS_EDGE_RESIDUAL_H

#include "elastica/kernels/graded_residual.h"

/* Unit vectors (c1, s1) from p0 to p1 and (c2, s2) from p3 to p2, and the edges' lengths in chords. */
typedef struct {
  HB_REAL c1, s1, c2, s2, l1, l2;
} hb_edges;

typedef struct {
  HB_REAL e, bound, status, by_l1, by_l2;
} hb_edge_residual;

/* The sums of dR and dK by one length, and the direction in which it moves its control point. */
typedef struct {
  HB_REAL cos, sin, q0, q1, q2, along_fit, misfit, total;
} hb_edge_rate;

HB_INLINE hb_legs hb_legs_of_edges(const hb_edges* a) {
  hb_legs p;
  p.x1 = a->l1 * a->c1;
  p.y1 = a->l1 * a->s1;
  p.x2 = HB_BROADCAST(1.0) + a->l2 * a->c2;
  p.y2 = a->l2 * a->s2;
  p.x3 = HB_BROADCAST(1.0);
  p.y3 = HB_BROADCAST(0.0);
  return p;
}

/* Edges that are not finite, or so long that squares overflow. */
HB_INLINE HB_REAL hb_edges_status(const hb_edges* a) {
  const HB_REAL sum =
      HB_ABS(a->c1) + HB_ABS(a->s1) + HB_ABS(a->c2) + HB_ABS(a->s2) + HB_ABS(a->l1) + HB_ABS(a->l2);
  return HB_SELECT(sum < HB_BROADCAST(HB_GREATEST_EXTENT), HB_BROADCAST(HB_RESIDUAL_OK),
                   HB_BROADCAST(HB_RESIDUAL_NOT_FINITE));
}

/* By 24 nodes, and by graded panels. */
HB_INLINE hb_residual hb_edge_residual_of(const hb_edges* a) {
  const hb_legs p = hb_legs_of_edges(a);
  return hb_plain_residual(&p, hb_edges_status(a));
}

HB_INLINE hb_residual hb_graded_edge_residual_of(const hb_edges* a) {
  const hb_legs p = hb_legs_of_edges(a);
  return hb_graded_residual(&p, hb_edges_status(a));
}

/* How the numerator x'y'' - y'x'' changes when control point 1 or 2 moves along (cos, sin): the moved point's
 * Bernstein polynomial has the power coefficients d in u. */
HB_INLINE hb_edge_rate hb_edge_rate_of(const hb_cubic* c, const hb_affine* f, HB_REAL cos, HB_REAL sin,
                                       double d1, double d2, double d3) {
  const HB_REAL two = HB_BROADCAST(2.0), six = HB_BROADCAST(6.0);
  const HB_REAL b1 = HB_BROADCAST(d1), b2 = HB_BROADCAST(d2), b3 = HB_BROADCAST(d3);
  const HB_REAL t1 = cos * c->y1 - sin * c->x1, t2 = cos * c->y2 - sin * c->x2,
                t3 = cos * c->y3 - sin * c->x3;
  hb_edge_rate r;
  r.cos = cos;
  r.sin = sin;
  r.q0 = two * (b1 * t2 - b2 * t1);
  r.q1 = six * (b1 * t3 - b3 * t1);
  r.q2 = six * (b2 * t3 - b3 * t2);
  r.along_fit = f->x * cos + f->y * sin;
  r.misfit = HB_BROADCAST(0.0);
  r.total = HB_BROADCAST(0.0);
  return r;
}

/* Adds one node's share: basis and slope are the moved point's Bernstein polynomial and its derivative there,
 * (tx, ty) the unit tangent, r the misfit, all else as in hb_nodes. */
HB_INLINE void hb_add_edge_rate(hb_edge_rate* a, HB_REAL u, HB_REAL weight, HB_REAL basis, HB_REAL slope,
                                HB_REAL tx, HB_REAL ty, HB_REAL speed, HB_REAL inverse, HB_REAL kappa,
                                HB_REAL r) {
  const HB_REAL d_speed = slope * HB_FMA(tx, a->cos, ty * a->sin);
  const HB_REAL numerator = HB_FMA(HB_FMA(a->q2, u, a->q1), u, a->q0) * (inverse * inverse);
  const HB_REAL d_kappa = HB_FMA(HB_BROADCAST(-3.0) * kappa, d_speed, numerator); /* times speed */
  const HB_REAL d_misfit = HB_FMA(-(speed * basis), a->along_fit, d_kappa);       /* times speed */
  const HB_REAL two = HB_BROADCAST(2.0);
  a->misfit = HB_FMA(weight * r, HB_FMA(d_speed, r, two * d_misfit), a->misfit);
  a->total = HB_FMA(weight * kappa, HB_FMA(d_speed, kappa, two * d_kappa), a->total);
}

HB_INLINE HB_REAL hb_edge_gradient(const hb_edge_rate* a, HB_REAL e, HB_REAL total) {
  const HB_REAL gradient = (a->misfit - e * e * a->total) / (HB_BROADCAST(2.0) * e * total);
  /* At e = 0, a minimum, there is a kink or nothing to follow. */
  return HB_SELECT(e > HB_BROADCAST(0.0), gradient, HB_BROADCAST(0.0));
}

/* Both lengths' sums. */
typedef struct {
  hb_edge_rate first, second;
  HB_REAL misfit;
} hb_edge_rates;

/* 3 t (1-t)^2 and 3 t^2 (1-t) in powers of u. */
HB_INLINE hb_edge_rates hb_edge_rates_of(const hb_edges* a, const hb_cubic* c, const hb_affine* f) {
  hb_edge_rates r;
  r.first = hb_edge_rate_of(c, f, a->c1, a->s1, -0.75, -1.5, 3.0);
  r.second = hb_edge_rate_of(c, f, a->c2, a->s2, 0.75, -1.5, -3.0);
  r.misfit = HB_BROADCAST(0.0);
  return r;
}

/* Adds the shares of one node to all sums. */
HB_INLINE void hb_add_edge_node(hb_edge_rates* rates, const hb_cubic* c, const hb_affine* f, const hb_node* n,
                                HB_REAL weight) {
  const HB_REAL one_half = HB_BROADCAST(0.5), three = HB_BROADCAST(3.0), one = HB_BROADCAST(1.0);
  const HB_REAL u = n->u, inverse = n->inverse, kappa = n->kappa;
  const HB_REAL two_u = u + u, three_uu = three * (u * u), t = one_half + u, o = one_half - u;
  const HB_REAL tx = HB_FMA(three_uu, c->x3, HB_FMA(two_u, c->x2, c->x1)) * inverse;
  const HB_REAL ty = HB_FMA(three_uu, c->y3, HB_FMA(two_u, c->y2, c->y1)) * inverse;
  const HB_REAL r = hb_fit_misfit(f, n), speed = one / inverse, to = three * (t * o);
  hb_add_edge_rate(&rates->first, u, weight, to * o, three * o * (o - t - t), tx, ty, speed, inverse, kappa,
                   r);
  hb_add_edge_rate(&rates->second, u, weight, to * t, three * t * (o + o - t), tx, ty, speed, inverse, kappa,
                   r);
  rates->misfit += (r * n->ds) * r;
}

HB_INLINE hb_edge_residual hb_edge_answer(const hb_edge_rates* rates, const hb_residual* r, HB_REAL total) {
  hb_edge_residual out;
  out.e = r->e;
  out.bound = r->bound;
  out.status = r->status;
  out.by_l1 = hb_edge_gradient(&rates->first, r->e, total);
  out.by_l2 = hb_edge_gradient(&rates->second, r->e, total);
  return out;
}

/* e, its bound, status, de/dl1 and de/dl2 of a curve in standard position, by 24 nodes. */
HB_INLINE hb_edge_residual hb_edge_residual_gradient(const hb_edges* a) {
  const hb_legs p = hb_legs_of_edges(a);
  const hb_cubic c = hb_cubic_of_legs(&p);
  const hb_speed_roots roots = hb_speed_roots_of(&c, 1);
  const hb_rule_error rule = hb_rule_error_of(&roots);
  hb_nodes n;
  const hb_moments m = hb_residual_moments(&c, &n);
  const hb_affine f = hb_affine_of_moments(&c, &m);
  hb_edge_rates rates = hb_edge_rates_of(a, &c, &f);
  for (int i = 0; i < HB_GAUSS_PAIRS; ++i) {
    const HB_REAL u = HB_BROADCAST(hb_gauss[i][0]), w = HB_BROADCAST(hb_gauss[i][HB_GAUSS_WEIGHT]);
    const hb_node plus = {u, n.ds[2 * i], n.inverse[2 * i], n.kappa[2 * i]};
    const hb_node minus = {-u, n.ds[2 * i + 1], n.inverse[2 * i + 1], n.kappa[2 * i + 1]};
    hb_add_edge_node(&rates, &c, &f, &plus, w);
    hb_add_edge_node(&rates, &c, &f, &minus, w);
  }
  const HB_REAL e = hb_root_share(rates.misfit, m.kk);
  const HB_REAL bound = hb_residual_bound(&p, &rule, &f, m.kk, e);
  const hb_residual r = hb_residual_or_zero(e, bound, hb_status_of(&p, &c, hb_edges_status(a)));
  return hb_edge_answer(&rates, &r, m.kk);
}

/* The same by graded panels. */
HB_INLINE hb_edge_residual hb_graded_edge_gradient(const hb_edges* a) {
  const hb_legs p = hb_legs_of_edges(a);
  const hb_cubic c = hb_cubic_of_legs(&p);
  const hb_speed_roots roots = hb_speed_roots_of(&c, 0);
  HB_REAL reached;
  const hb_moments m = hb_graded_moments(&c, &roots, &reached);
  const hb_affine f = hb_affine_of_moments(&c, &m);
  hb_edge_rates rates = hb_edge_rates_of(a, &c, &f);
  const HB_REAL end = HB_BROADCAST(0.5), one = HB_BROADCAST(1.0);
  HB_REAL from = -end;
  for (int k = 0; k < HB_MOST_PANELS && HB_ANY(from < end); ++k) {
    const HB_REAL to = hb_panel_end(&roots, from);
    for (int i = 0; i < HB_GAUSS_PAIRS; ++i) {
      const HB_REAL w = HB_BROADCAST(hb_gauss[i][HB_GAUSS_WEIGHT]) * (to - from);
      const hb_node minus = hb_panel_node(&c, from, to, i, -1.0), plus = hb_panel_node(&c, from, to, i, 1.0);
      hb_add_edge_node(&rates, &c, &f, &minus, w);
      hb_add_edge_node(&rates, &c, &f, &plus, w);
    }
    from = to;
  }
  const HB_REAL e = hb_root_share(rates.misfit, m.kk), slowest = hb_least_speed2(&c, &roots);
  const HB_REAL bound = HB_SELECT(reached < end, one, hb_graded_bound(&p, slowest, e));
  const HB_REAL status = hb_status_of_speed(hb_status_of(&p, &c, hb_edges_status(a)), slowest);
  const hb_residual r = hb_residual_or_zero(e, bound, status);
  return hb_edge_answer(&rates, &r, m.kk);
}

#endif
