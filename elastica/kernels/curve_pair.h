/* A cubic Bezier against an elastica: the paper's L2 and H1, and bounds of the Hausdorff distance
 * (elastica/bezier/curve_distance.hpp).
 *
 * Frame: the elastica starts at the origin. */
#ifndef HOTBLADE_ELASTICA_KERNELS_CURVE_PAIR_H
#define HOTBLADE_ELASTICA_KERNELS_CURVE_PAIR_H

#include "elastica/kernels/elastica_step.h"

#define HB_PANEL_NODES 5

/* The 5-point Gauss rule on [0, 1]: node, weight, and the integrals from 0 to the node of the polynomials
 * that are 1 at one node and 0 at the others. */
HB_CONSTANT double hb_panel[HB_PANEL_NODES][2 + HB_PANEL_NODES] = {
    {0.0469100770306680036, 0.1184634425280945438, 0.05923172126404727188, -0.01957036435907603749,
     0.01125440081864295555, -0.005593793660812184877, 0.001588112967865998539},
    {0.2307653449471584545, 0.239314335249683234, 0.1281510056700452835, 0.119657167624841617,
     -0.02459211461964220039, 0.01031828067068335741, -0.002768994398769603044},
    {0.5, 0.2844444444444444444, 0.1137762880042246025, 0.2600046516806415186, 0.1422222222222222222,
     -0.02069031643095828457, 0.004687154523869941228},
    {0.7692346550528415455, 0.239314335249683234, 0.1212324369268641468, 0.2289960545789998766,
     0.3090365590640866448, 0.119657167624841617, -0.009687563141950739739},
    {0.9530899229693319964, 0.1184634425280945438, 0.1168753295602285452, 0.2449081289104954189,
     0.2731900436258014889, 0.2588846996087592715, 0.05923172126404727188}};

/* b0 + t (a1 + t (a2 + t a3)) by axis; `start` is at the origin; |kappa| <= bend on the elastica. */
typedef struct {
  HB_REAL x0, x1, x2, x3, y0, y1, y2, y3;
  hb_elastica_field field;
  hb_elastica_point start;
  HB_REAL length, bend;
} hb_pair;

/* `length` is the Bezier's. Where that is 0, both differences are NaN. */
typedef struct {
  HB_REAL l2, h1, length;
} hb_pair_difference;

typedef struct {
  HB_REAL lower, upper;
} hb_pair_bounds;

/* A place on the elastica. */
typedef struct {
  HB_REAL s, x, y;
} hb_pair_node;

typedef struct {
  HB_REAL x, y;
} hb_plane;

HB_INLINE hb_plane hb_pair_bezier(const hb_pair* a, HB_REAL t) {
  hb_plane p;
  p.x = HB_FMA(HB_FMA(HB_FMA(a->x3, t, a->x2), t, a->x1), t, a->x0);
  p.y = HB_FMA(HB_FMA(HB_FMA(a->y3, t, a->y2), t, a->y1), t, a->y0);
  return p;
}

HB_INLINE hb_plane hb_pair_derivative(const hb_pair* a, HB_REAL t) {
  const HB_REAL two = HB_BROADCAST(2.0), three = HB_BROADCAST(3.0);
  hb_plane p;
  p.x = HB_FMA(HB_FMA(three * a->x3, t, two * a->x2), t, a->x1);
  p.y = HB_FMA(HB_FMA(three * a->y3, t, two * a->y2), t, a->y1);
  return p;
}

HB_INLINE HB_REAL hb_norm(HB_REAL x, HB_REAL y) {
  return HB_SQRT(HB_FMA(x, x, y * y));
}

/* |B''|, convex in t. */
HB_INLINE HB_REAL hb_pair_bezier_bend(const hb_pair* a, HB_REAL t) {
  const HB_REAL two = HB_BROADCAST(2.0), six = HB_BROADCAST(6.0);
  return hb_norm(HB_FMA(six * a->x3, t, two * a->x2), HB_FMA(six * a->y3, t, two * a->y2));
}

/* The angle in [-pi, pi] of the direction (c, s), |(c, s)| = 1 or both 0, which gives 0. The tangent of an
 * eighth of it is below 0.2 where c >= 0; its series ends below rounding. */
HB_INLINE HB_REAL hb_angle_of(HB_REAL c, HB_REAL s) {
  const HB_REAL one = HB_BROADCAST(1.0), zero = HB_BROADCAST(0.0), pi = HB_BROADCAST(3.14159265358979323846);
  const HB_REAL of_half = s / (one + HB_ABS(c));
  const HB_REAL quarter = of_half / (one + HB_SQRT(HB_FMA(of_half, of_half, one)));
  const HB_REAL t = quarter / (one + HB_SQRT(HB_FMA(quarter, quarter, one))), z = t * t;
  HB_REAL sum = HB_BROADCAST(1.0 / 21);
#pragma GCC unroll 16
  for (int k = 9; k >= 0; --k) sum = HB_FMA(-z, sum, HB_BROADCAST(1.0 / (2 * k + 1)));
  const HB_REAL acute = HB_BROADCAST(8.0) * (t * sum);
  return HB_SELECT(c < zero, HB_SELECT(s < zero, -pi, pi) - acute, acute);
}

/* Speeds at the nodes of the panel that begins at t; returns the panel's arc length. */
HB_INLINE HB_REAL hb_panel_speeds(const hb_pair* a, double t, double h, HB_REAL* speed) {
  HB_REAL sum = HB_BROADCAST(0.0);
  for (int i = 0; i < HB_PANEL_NODES; ++i) {
    const hb_plane d = hb_pair_derivative(a, HB_BROADCAST(t + h * hb_panel[i][0]));
    speed[i] = hb_norm(d.x, d.y);
    sum = HB_FMA(HB_BROADCAST(h * hb_panel[i][1]), speed[i], sum);
  }
  return sum;
}

/* Adds one node's share to both sums. */
HB_INLINE void hb_add_difference(const hb_pair* a, double t, HB_REAL speed, HB_REAL weight,
                                 const hb_elastica_point* g, HB_REAL* square, HB_REAL* angle) {
  const HB_REAL zero = HB_BROADCAST(0.0);
  const hb_plane p = hb_pair_bezier(a, HB_BROADCAST(t)), d = hb_pair_derivative(a, HB_BROADCAST(t));
  const HB_REAL x = p.x - g->x, y = p.y - g->y;
  const HB_REAL per = HB_SELECT(speed > zero, HB_BROADCAST(1.0) / speed, zero);
  const HB_REAL turn = hb_angle_of((d.x * g->c + d.y * g->s) * per, (d.x * g->s - d.y * g->c) * per);
  *square = HB_FMA(weight, HB_FMA(x, x, y * y), *square);
  *angle = HB_FMA(weight, turn * turn, *angle);
}

/* L2 and H1 over `panels` times 5 nodes; the elastica is traversed proportionally to the Bezier's length. */
HB_INLINE hb_pair_difference hb_pair_differences(const hb_pair* a, int panels) {
  const double h = 1.0 / panels;
  HB_REAL speed[HB_PANEL_NODES], length = HB_BROADCAST(0.0), square = length, angle = length;
  for (int i = 0; i < panels; ++i) length += hb_panel_speeds(a, i * h, h, speed);
  const HB_REAL stretch = a->length / length;
  hb_elastica_point g = a->start;
  HB_REAL from = HB_BROADCAST(0.0), at = from; /* the panel's start and g's place, by the Bezier's length */
  for (int i = 0; i < panels; ++i) {
    const HB_REAL panel = hb_panel_speeds(a, i * h, h, speed);
    for (int n = 0; n < HB_PANEL_NODES; ++n) {
      HB_REAL to = from;
      for (int j = 0; j < HB_PANEL_NODES; ++j)
        to = HB_FMA(HB_BROADCAST(h * hb_panel[n][2 + j]), speed[j], to);
      hb_elastica_move(&a->field, (to - at) * stretch, &g);
      at = to;
      hb_add_difference(a, (i + hb_panel[n][0]) * h, speed[n], HB_BROADCAST(h * hb_panel[n][1]) * speed[n],
                        &g, &square, &angle);
    }
    from += panel;
  }
  hb_pair_difference out;
  const HB_REAL l2 = square / (length * length * length);
  out.l2 = HB_SQRT(l2);
  out.h1 = HB_SQRT(l2 + angle / length);
  out.length = length;
  return out;
}

/* A place on the elastica that serves as foot of a point of the Bezier. */
typedef struct {
  hb_elastica_point q;
  HB_REAL s, x, y, d, along; /* the Bezier's point, its distance, and (q - p).tangent */
} hb_pair_foot;

HB_INLINE void hb_foot_to(const hb_pair* a, HB_REAL s, hb_pair_foot* f) {
  const HB_REAL zero = HB_BROADCAST(0.0), to = HB_MAX(HB_MIN(s, a->length), zero);
  hb_elastica_move(&a->field, to - f->s, &f->q);
  f->s = to;
  const HB_REAL x = f->q.x - f->x, y = f->q.y - f->y;
  f->d = hb_norm(x, y);
  f->along = HB_FMA(x, f->q.c, y * f->q.s);
}

/* One step of Newton's method. (q - p).tangent grows by 1 + kappa (q - p).normal; where that is small the
 * foot is on its way to vanish, and half serves. */
HB_INLINE void hb_foot_improve(const hb_pair* a, hb_pair_foot* f) {
  const HB_REAL off = (f->q.y - f->y) * f->q.c - (f->q.x - f->x) * f->q.s;
  const HB_REAL slope = HB_FMA(hb_elastica_curvature(&a->field, &f->q), off, HB_BROADCAST(1.0));
  hb_foot_to(a, f->s - f->along / HB_MAX(slope, HB_BROADCAST(0.5)), f);
}

/* From below: the distance of the foot's point to the elastica, whose nodes are given.
 * Within arc length w of the foot, half the squared distance has the second derivative 1 + kappa (q - p).n >=
 * 1
 * - K (d + w) = m, so it falls short of the foot's by along^2 / 2m at most, or not at all where the foot is
 * an end and the elastica leads away. Outside, a piece with distances D, E at its ends, length l, is no
 * nearer than (D + E - l) / 2. */
HB_INLINE HB_REAL hb_from_bezier(const hb_pair* a, const hb_pair_foot* f, HB_GLOBAL const hb_pair_node* nodes,
                                 int count, int stride) {
  const HB_REAL zero = HB_BROADCAST(0.0), a_half = HB_BROADCAST(0.5);
  const HB_REAL bend = HB_MAX(a->bend, HB_BROADCAST(1e-30)); /* a line's: of any window the frame has */
  const HB_REAL w = a_half * (HB_BROADCAST(1.0) / bend - f->d),
                m = a_half * (HB_BROADCAST(1.0) - bend * f->d);
  const HB_MASK ends = ((f->s <= zero) & (f->along >= zero)) | ((f->s >= a->length) & (f->along <= zero));
  const HB_REAL square = f->d * f->d - HB_SELECT(ends, zero, f->along * f->along / m);
  HB_REAL least = HB_SELECT(m > zero, HB_SQRT(HB_MAX(square, zero)), zero);
  HB_REAL d = hb_norm(nodes[0].x - f->x, nodes[0].y - f->y);
  for (int i = 1; i < count; ++i) {
    HB_GLOBAL const hb_pair_node *before = nodes + (i - 1) * stride, *node = nodes + i * stride;
    const HB_REAL e = hb_norm(node->x - f->x, node->y - f->y);
    const HB_REAL reach = HB_MAX(HB_ABS(node->s - f->s), HB_ABS(before->s - f->s));
    const HB_REAL near = a_half * (d + e - HB_ABS(node->s - before->s));
    least = HB_SELECT(reach > w, HB_MIN(near, least), least);
    d = e;
  }
  return HB_MAX(least, zero);
}

/* From below: the distance of an end (x, y) of the elastica to the Bezier, whose end of that side is t = 0
 * or 1. The same in t: half the squared distance has the second derivative |B'|^2 + (B - q).B'' >= m within
 * w, as |B'|
 * >= v - A w there, A the largest |B''|, V the largest speed. */
HB_INLINE HB_REAL hb_from_end(const hb_pair* a, HB_REAL x, HB_REAL y, double end, int samples,
                              HB_REAL most_speed, HB_REAL most_bend) {
  const HB_REAL zero = HB_BROADCAST(0.0), one = HB_BROADCAST(1.0), a_half = HB_BROADCAST(0.5),
                t = HB_BROADCAST(end);
  const hb_plane p = hb_pair_bezier(a, t), v = hb_pair_derivative(a, t);
  const HB_REAL rx = p.x - x, ry = p.y - y, d = hb_norm(rx, ry), speed = hb_norm(v.x, v.y);
  const HB_REAL w = HB_MIN(one, HB_BROADCAST(0.25) * speed / HB_MAX(most_bend, HB_BROADCAST(1e-30)));
  const HB_REAL slow = speed - most_bend * w;
  const HB_REAL m = slow * slow - (d + most_speed * w) * most_bend;
  HB_REAL along = rx * v.x + ry * v.y; /* into the Bezier */
  if (end > 0.5) along = -along;
  const HB_REAL square = d * d - HB_SELECT(along < zero, along * along / m, zero);
  HB_REAL least = HB_SELECT(m > zero, HB_SQRT(HB_MAX(square, zero)), zero);
  const HB_REAL l = most_speed * HB_BROADCAST(1.0 / samples);
  HB_REAL before = d;
  for (int i = 1; i <= samples; ++i) {
    const double far = (double)i / samples;
    const hb_plane q = hb_pair_bezier(a, HB_BROADCAST(end > 0.5 ? 1 - far : far));
    const HB_REAL e = hb_norm(q.x - x, q.y - y), near = a_half * (before + e - l);
    least = HB_SELECT(HB_BROADCAST(far) > w, HB_MIN(near, least), least);
    before = e;
  }
  return HB_MAX(least, zero);
}

HB_INLINE void hb_farther_foot(const hb_pair_foot* f, hb_pair_foot* most) {
  const HB_MASK farther = f->d > most->d;
  most->s = HB_SELECT(farther, f->s, most->s);
  most->x = HB_SELECT(farther, f->x, most->x);
  most->y = HB_SELECT(farther, f->y, most->y);
  most->along = HB_SELECT(farther, f->along, most->along);
  most->d = HB_SELECT(farther, f->d, most->d);
}

/* |B'' - (d/dt)^2 g(s(t))| at a foot q where s has these derivatives. */
HB_INLINE HB_REAL hb_parting_bend(const hb_pair* a, HB_REAL t, const hb_elastica_point* q, HB_REAL rate,
                                  HB_REAL growth) {
  const HB_REAL two = HB_BROADCAST(2.0), six = HB_BROADCAST(6.0);
  const HB_REAL pull = hb_elastica_curvature(&a->field, q) * (rate * rate);
  const HB_REAL x = HB_FMA(six * a->x3, t, two * a->x2) - (growth * q->c - pull * q->s);
  const HB_REAL y = HB_FMA(six * a->y3, t, two * a->y2) - (growth * q->s + pull * q->c);
  return hb_norm(x, y);
}

/* How far the difference D(t) = B(t) - g(s(t)) may exceed its ends' on an interval of length h up to t, s
 * being the quadratic from foot to foot that grows as the Bezier's speed does: h^2/8 max |D''|, which exceeds
 * its ends' by h/2 max |D'''| at most. Growth is cut so that s stays between the feet. */
HB_INLINE HB_REAL hb_parting(const hb_pair* a, double t, double h, HB_REAL step,
                             const hb_elastica_point* from, const hb_elastica_point* to) {
  const HB_REAL two = HB_BROADCAST(2.0), three = HB_BROADCAST(3.0), six = HB_BROADCAST(6.0);
  const HB_REAL half_h = HB_BROADCAST(0.5 * h), end = HB_BROADCAST(t), begin = HB_BROADCAST(t - h);
  const HB_REAL bx = HB_FMA(six * a->x3, end - half_h, two * a->x2);
  const HB_REAL by = HB_FMA(six * a->y3, end - half_h, two * a->y2);
  const HB_REAL rate = step * HB_BROADCAST(1 / h), most = HB_ABS(rate) * HB_BROADCAST(2 / h);
  const HB_REAL wanted = HB_BROADCAST(0.5) * (bx * (from->c + to->c) + by * (from->s + to->s));
  const HB_REAL growth = HB_MAX(HB_MIN(wanted, most), -most), change = growth * half_h;
  const HB_REAL at_from = hb_parting_bend(a, begin, from, rate - change, growth);
  const HB_REAL at_to = hb_parting_bend(a, end, to, rate + change, growth);
  const HB_REAL fast = HB_ABS(rate) + HB_ABS(change), bend = a->bend;
  const HB_REAL tension = hb_norm(a->field.l1, a->field.l2);
  const HB_REAL third = six * hb_norm(a->x3, a->y3) + ((tension + bend * bend) * (fast * fast)) * fast +
                        three * (bend * fast) * HB_ABS(growth);
  return HB_BROADCAST(h * h / 8) * HB_FMA(half_h, third, HB_MAX(at_from, at_to));
}

/* The foot of the Bezier's next sample, from the one before; the bound of all points of either curve between
 * them. Chords that are run through together are no farther apart than at their ends, and a curve leaves its
 * chord by |second derivative| / 8 at most; for curves that bend alike the difference itself leaves less. */
HB_INLINE HB_REAL hb_pair_advance(const hb_pair* a, double t, double h, HB_REAL* bezier_bend,
                                  hb_pair_foot* f) {
  const HB_REAL before = f->d, s = f->s, bend = hb_pair_bezier_bend(a, HB_BROADCAST(t));
  const hb_plane p = hb_pair_bezier(a, HB_BROADCAST(t));
  const hb_elastica_point from = f->q;
  f->x = p.x;
  f->y = p.y;
  hb_foot_to(a, s + ((p.x - f->q.x) * f->q.c + (p.y - f->q.y) * f->q.s), f);
  hb_foot_improve(a, f);
  const HB_REAL step = f->s - s, eighth = HB_BROADCAST(0.125);
  const HB_REAL sag = eighth * HB_FMA(a->bend * step, step, HB_MAX(bend, *bezier_bend) * HB_BROADCAST(h * h));
  *bezier_bend = bend;
  const HB_REAL parting = hb_parting(a, t, h, step, &from, &f->q);
  return HB_MAX(before, f->d) + HB_MIN(sag, parting);
}

HB_INLINE void hb_set_node(HB_GLOBAL hb_pair_node* node, const hb_pair_foot* f) {
  node->s = f->s;
  node->x = f->q.x;
  node->y = f->q.y;
}

/* Bounds of the Hausdorff distance, both ways, from the feet of samples + 1 points of the Bezier, each sought
 * from the one before. Any feet give an upper bound, good feet one that is too large by the curves' deviation
 * from their chords; what is beyond the first and last foot goes to the Bezier's end. `nodes` has room for
 * samples + 3, which lie `stride` apart. */
HB_INLINE hb_pair_bounds hb_pair_hausdorff(const hb_pair* a, int samples, HB_GLOBAL hb_pair_node* nodes,
                                           int stride) {
  const HB_REAL zero = HB_BROADCAST(0.0), eighth = HB_BROADCAST(0.125);
  const double h = 1.0 / samples;
  hb_pair_foot f, most;
  f.q = a->start;
  f.s = zero;
  f.x = a->x0;
  f.y = a->y0;
  hb_foot_to(a, zero, &f);
  HB_REAL upper = f.d, bezier_bend = hb_pair_bezier_bend(a, zero);
  const HB_REAL first_bend = bezier_bend;
  nodes[0].s = nodes[0].x = nodes[0].y = zero;
  for (int i = 0; i < 3; ++i) hb_foot_improve(a, &f);
  upper = HB_MAX(upper, f.d) + eighth * (a->bend * f.s) * f.s;
  most = f;
  for (int i = 0; i <= samples; ++i) {
    if (i > 0) {
      /* HB_MAX may evaluate its arguments twice. */
      const HB_REAL between = hb_pair_advance(a, i * h, h, &bezier_bend, &f);
      upper = HB_MAX(upper, between);
      hb_farther_foot(&f, &most);
    }
    hb_set_node(nodes + (i + 1) * stride, &f);
  }
  const HB_REAL rest = a->length - f.s, last = f.d;
  hb_foot_to(a, a->length, &f);
  upper = HB_MAX(upper, HB_MAX(last, f.d) + eighth * (a->bend * rest) * rest);
  hb_set_node(nodes + (samples + 2) * stride, &f);

  const HB_REAL most_bend = HB_MAX(first_bend, bezier_bend);
  /* B' is a mean of its control points, three times the edges. */
  const hb_plane end = hb_pair_derivative(a, HB_BROADCAST(1.0));
  const HB_REAL most_speed =
      HB_MAX(HB_MAX(hb_norm(a->x1, a->y1), hb_norm(end.x, end.y)), hb_norm(a->x1 + a->x2, a->y1 + a->y2));
  hb_pair_bounds out;
  out.upper = upper;
  out.lower = hb_from_bezier(a, &most, nodes, samples + 3, stride);
  const HB_REAL start = hb_from_end(a, zero, zero, 0.0, samples, most_speed, most_bend);
  const HB_REAL finish = hb_from_end(a, f.q.x, f.q.y, 1.0, samples, most_speed, most_bend);
  out.lower = HB_MAX(out.lower, HB_MAX(start, finish));
  return out;
}

#endif
