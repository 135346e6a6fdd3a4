/* Lays out a curve prepared for nearest-point queries in memory, on the host and on a device: polynomial
 * pieces of degree three or less, each with its chord and what bounds the squared distance to it. */
#ifndef HOTBLADE_GPU_KERNELS_CURVE_PIECES_H
#define HOTBLADE_GPU_KERNELS_CURVE_PIECES_H

/* Points of a whole curve that a search starts from. */
#define HB_CURVE_STARTS 5

/* B(u) = from + c1 u + c2 u^2 + c3 u^3 for u in [0, 1]; the curve's parameter is t + u dt. The piece strays
 * from its chord from + s leg by at most sag; inv is 1 / |leg|^2, or 0.
 *
 * With r = query - from, half the second derivative of the squared distance, |B'|^2 + (B - from - r).B'',
 * lies between the least and the largest of its Bernstein coefficients bend[k] - r.((1 - k/4) first + k/4
 * last). Rounding takes at most guard0 + guard1 |B - query| from it. `size` is the curve's largest coordinate
 * in its frame. */
typedef struct {
  double from_x, from_y, leg_x, leg_y, inv, sag;
  double c1_x, c1_y, c2_x, c2_y, c3_x, c3_y;
  double bend[5], first_x, first_y, last_x, last_y, guard0, guard1;
  double t, dt, size;
} hb_curve_piece;

/* One polynomial as a whole, with points on it at u = 0, 1/4 .. 1: half_sq is half the squared length. */
typedef struct {
  hb_curve_piece piece;
  double start_x[HB_CURVE_STARTS], start_y[HB_CURVE_STARTS], half_sq[HB_CURVE_STARTS];
} hb_curve_whole;

#endif
