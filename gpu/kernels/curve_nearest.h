/* Finds the nearest point of a curve to a query, in the common subset of C++ (lane by lane) and OpenCL C.
 *
 * Where the squared distance is convex over a piece - its second derivative's Bernstein coefficients tell -
 * the minimum there is the only one, and how far a point is from it follows from the slope: with D half the
 * squared distance and D'' >= m, d^2 - d_min^2 <= D'^2 / m. So an answer is either proven, to HB_CURVE_ERROR,
 * or left to the careful search on the host (gpu/curve/curve_search.cpp). A curve that is one polynomial is first
 * tried as a whole, then piece by piece: only pieces whose chord is within reach count. */
#ifndef HOTBLADE_GPU_KERNELS_CURVE_NEAREST_H
#define HOTBLADE_GPU_KERNELS_CURVE_NEAREST_H

#include "elastica/kernels/real.h"
#include "gpu/kernels/curve_pieces.h"

/* Steps of Halley's method. From the nearest start of a curve that turns by a right angle each one cubes what
 * is left, about 0.1, 1e-3, 1e-9; the slope then proves it. */
#define HB_CURVE_STEPS 2

/* Accepted error of a distance, of the curve's size and the distance together. */
#define HB_CURVE_ERROR 2e-15

/* Distances and squared distances from here on are the careful search's: squares overflow. */
#define HB_CURVE_FAR 1e150

typedef struct {
  HB_REAL distance, t;
  HB_MASK settled;
} hb_curve_foot;

/* Offset from the query, velocity, and half the squared distance's first and second derivative. */
typedef struct {
  HB_REAL x, y, vx, vy, slope;
} hb_curve_state;

HB_INLINE hb_curve_state hb_curve_state_at(HB_GLOBAL const hb_curve_piece* p, HB_REAL rx, HB_REAL ry,
                                           HB_REAL u) {
  const HB_REAL c1x = HB_BROADCAST(p->c1_x), c2x = HB_BROADCAST(p->c2_x), c3x = HB_BROADCAST(p->c3_x);
  const HB_REAL c1y = HB_BROADCAST(p->c1_y), c2y = HB_BROADCAST(p->c2_y), c3y = HB_BROADCAST(p->c3_y);
  /* Horner's scheme and its derivative: the second sum is B / u less its start, and so on. */
  const HB_REAL ax = HB_FMA(c3x, u, c2x), bx = HB_FMA(ax, u, c1x);
  const HB_REAL ay = HB_FMA(c3y, u, c2y), by = HB_FMA(ay, u, c1y);
  hb_curve_state s;
  s.x = HB_FMA(bx, u, -rx);
  s.y = HB_FMA(by, u, -ry);
  s.vx = HB_FMA(HB_FMA(c3x, u, ax), u, bx);
  s.vy = HB_FMA(HB_FMA(c3y, u, ay), u, by);
  s.slope = HB_FMA(s.x, s.vx, s.y * s.vy);
  return s;
}

HB_INLINE HB_REAL hb_curve_clamped(HB_REAL u) {
  u = HB_MAX(u, HB_BROADCAST(0.0));
  return HB_MIN(u, HB_BROADCAST(1.0));
}

HB_INLINE HB_REAL hb_curve_step(HB_GLOBAL const hb_curve_piece* p, HB_REAL rx, HB_REAL ry, HB_REAL u) {
  const hb_curve_state s = hb_curve_state_at(p, rx, ry, u);
  const HB_REAL two = HB_BROADCAST(2.0), three = HB_BROADCAST(3.0);
  const HB_REAL c3x = HB_BROADCAST(p->c3_x), c3y = HB_BROADCAST(p->c3_y);
  /* Half the curve's second derivative. */
  const HB_REAL hx = HB_FMA(three * c3x, u, HB_BROADCAST(p->c2_x)),
                hy = HB_FMA(three * c3y, u, HB_BROADCAST(p->c2_y));
  const HB_REAL bend = HB_FMA(two, HB_FMA(s.x, hx, s.y * hy), HB_FMA(s.vx, s.vx, s.vy * s.vy));
  /* A sixth of bend's derivative. */
  const HB_REAL rate = HB_FMA(s.x, c3x, HB_FMA(s.y, c3y, HB_FMA(s.vx, hx, s.vy * hy)));
  const HB_REAL square = bend * bend, halley = HB_FMA(-three * s.slope, rate, square);
  /* Never more than twice Newton's step. */
  const HB_REAL below = HB_MAX(halley, HB_BROADCAST(0.5) * square);
  return hb_curve_clamped(u - (s.slope * bend) / below);
}

/* The least that half the second derivative can be over the piece, without its guard. */
HB_INLINE HB_REAL hb_curve_least_bend(HB_GLOBAL const hb_curve_piece* p, HB_REAL rx, HB_REAL ry) {
  const HB_REAL first = HB_FMA(rx, HB_BROADCAST(p->first_x), ry * HB_BROADCAST(p->first_y));
  const HB_REAL last = HB_FMA(rx, HB_BROADCAST(p->last_x), ry * HB_BROADCAST(p->last_y));
  const HB_REAL quarter = HB_BROADCAST(0.25) * (last - first);
  HB_REAL middle = HB_MIN(HB_BROADCAST(p->bend[1]) - quarter,
                          HB_FMA(HB_BROADCAST(-2.0), quarter, HB_BROADCAST(p->bend[2])));
  middle = HB_MIN(middle, HB_FMA(HB_BROADCAST(-3.0), quarter, HB_BROADCAST(p->bend[3])));
  middle = HB_MIN(middle, HB_BROADCAST(p->bend[0])) - first;
  return HB_MIN(middle, HB_BROADCAST(p->bend[4]) - last);
}

/* From a start u, the nearest point of a piece to from + (rx, ry). NaN is not settled. */
HB_INLINE hb_curve_foot hb_curve_foot_on_piece(HB_GLOBAL const hb_curve_piece* p, HB_REAL rx, HB_REAL ry,
                                               HB_REAL u) {
  const HB_REAL zero = HB_BROADCAST(0.0), one = HB_BROADCAST(1.0);
  for (int i = 0; i < HB_CURVE_STEPS; ++i) u = hb_curve_step(p, rx, ry, u);
  const hb_curve_state s = hb_curve_state_at(p, rx, ry, u);
  hb_curve_foot foot;
  foot.distance = HB_SQRT(HB_FMA(s.x, s.x, s.y * s.y));
  foot.t = HB_FMA(HB_BROADCAST(p->dt), u, HB_BROADCAST(p->t));
  const HB_REAL least = hb_curve_least_bend(p, rx, ry) -
                        HB_FMA(HB_BROADCAST(p->guard1), foot.distance, HB_BROADCAST(p->guard0));
  const HB_REAL error = HB_BROADCAST(HB_CURVE_ERROR) * (foot.distance + HB_BROADCAST(p->size));
  const HB_MASK near = s.slope * s.slope <= least * (error * (error + foot.distance));
  /* At an end the curve may still fall, outwards. */
  const HB_REAL outwards = HB_SELECT(u >= one, -s.slope, HB_SELECT(u <= zero, s.slope, -one));
  foot.settled = (least > zero) & (foot.distance < HB_BROADCAST(HB_CURVE_FAR)) & (near | (outwards >= zero));
  return foot;
}

/* A curve that is one polynomial, tried as a whole; (x, y) in the curve's frame, whose origin is B(0). */
HB_INLINE hb_curve_foot hb_curve_foot_on_whole(HB_GLOBAL const hb_curve_whole* c, HB_REAL x, HB_REAL y) {
  /* The nearest start has the largest q.p - |p|^2 / 2; the first is the origin. */
  HB_REAL largest = HB_BROADCAST(0.0), u = HB_BROADCAST(0.0);
  for (int i = 1; i < HB_CURVE_STARTS; ++i) {
    const HB_REAL value = HB_FMA(x, HB_BROADCAST(c->start_x[i]),
                                 HB_FMA(y, HB_BROADCAST(c->start_y[i]), HB_BROADCAST(-c->half_sq[i])));
    u = HB_SELECT(value > largest, HB_BROADCAST(i * (1.0 / (HB_CURVE_STARTS - 1))), u);
    largest = HB_MAX(value, largest);
  }
  return hb_curve_foot_on_piece(&c->piece, x, y, u);
}

/* Squared distance to a piece's chord, and the share of the chord at its foot. */
HB_INLINE HB_REAL hb_curve_chord_sq(HB_GLOBAL const hb_curve_piece* p, HB_REAL rx, HB_REAL ry,
                                    HB_REAL* share) {
  const HB_REAL lx = HB_BROADCAST(p->leg_x), ly = HB_BROADCAST(p->leg_y);
  const HB_REAL s = hb_curve_clamped(HB_FMA(rx, lx, ry * ly) * HB_BROADCAST(p->inv));
  const HB_REAL dx = HB_FMA(-s, lx, rx), dy = HB_FMA(-s, ly, ry);
  *share = s;
  return HB_FMA(dx, dx, dy * dy);
}

/* The nearest point of `count` >= 1 pieces, none of which strays from its chord by more than `sag`. */
HB_INLINE hb_curve_foot hb_curve_foot_on_pieces(HB_GLOBAL const hb_curve_piece* pieces, int count, double sag,
                                                HB_REAL x, HB_REAL y) {
  HB_REAL least = HB_BROADCAST(HB_CURVE_FAR), share;
  for (int i = 0; i < count; ++i) {
    HB_GLOBAL const hb_curve_piece* p = pieces + i;
    least =
        HB_MIN(hb_curve_chord_sq(p, x - HB_BROADCAST(p->from_x), y - HB_BROADCAST(p->from_y), &share), least);
  }
  /* Some point of the curve is no farther than that, whatever rounding did. */
  const HB_REAL reach =
      HB_FMA(HB_SQRT(least), HB_BROADCAST(1.0 + 1e-14), HB_BROADCAST(sag + 1e-15 * pieces[0].size));
  hb_curve_foot best;
  best.distance = HB_BROADCAST(HB_CURVE_FAR);
  best.t = HB_BROADCAST(0.0);
  best.settled = least < HB_BROADCAST(HB_CURVE_FAR);
  for (int i = 0; i < count; ++i) {
    HB_GLOBAL const hb_curve_piece* p = pieces + i;
    const HB_REAL rx = x - HB_BROADCAST(p->from_x), ry = y - HB_BROADCAST(p->from_y);
    const HB_REAL sq = hb_curve_chord_sq(p, rx, ry, &share), far = reach + HB_BROADCAST(p->sag);
    const HB_MASK within = sq <= far * far;
    if (!HB_ANY(within)) continue;
    const hb_curve_foot foot = hb_curve_foot_on_piece(p, rx, ry, share);
    best.settled &= foot.settled | HB_NOT(within);
    const HB_MASK nearer = within & (foot.distance < best.distance);
    best.distance = HB_SELECT(nearer, foot.distance, best.distance);
    best.t = HB_SELECT(nearer, foot.t, best.t);
  }
  return best;
}

#endif
