/* Computes the distance of a point to a triangle in double precision, in the common subset of C, C++ and
 * OpenCL C: the one formula whose values reach a file, whichever backend searched. Only + - * / of IEEE 754
 * take part, in one order, and nothing may be fused, so that host and device give the same bits. */
#ifndef HOTBLADE_GPU_KERNELS_TRIANGLE_EXACT_H
#define HOTBLADE_GPU_KERNELS_TRIANGLE_EXACT_H

#include "elastica/kernels/real.h"

typedef struct {
  double x, y, z;
} hb_vec3;

/* The nearest point (x, y, z) of the triangle, its squared distance, and what it lies on: 0 the face, 1 the
 * edge from `corner` to the next one, 2 the vertex `corner`. */
typedef struct {
  double distance_sq, x, y, z;
  int feature, corner;
} hb_triangle_foot;

/* A square's inverse below this, the least normal number, may overflow: such an edge is a point. */
#define HB_LEAST_SQ 0x1p-1022

HB_INLINE hb_vec3 hb_minus(hb_vec3 a, hb_vec3 b) {
  hb_vec3 c;
  c.x = a.x - b.x;
  c.y = a.y - b.y;
  c.z = a.z - b.z;
  return c;
}

/* s a + t b. */
HB_INLINE hb_vec3 hb_sum_of(double s, hb_vec3 a, double t, hb_vec3 b) {
  hb_vec3 c;
  c.x = s * a.x + t * b.x;
  c.y = s * a.y + t * b.y;
  c.z = s * a.z + t * b.z;
  return c;
}

HB_INLINE hb_vec3 hb_times(double s, hb_vec3 a) {
  hb_vec3 c;
  c.x = s * a.x;
  c.y = s * a.y;
  c.z = s * a.z;
  return c;
}

HB_INLINE double hb_dot3(hb_vec3 a, hb_vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

HB_INLINE double hb_square_of(hb_vec3 a) {
  return hb_dot3(a, a);
}

HB_INLINE double hb_inverse_of(double square) {
  return square > HB_LEAST_SQ ? 1.0 / square : 0.0;
}

HB_INLINE double hb_share(double t) {
  return t < 0.0 ? 0.0 : (1.0 < t ? 1.0 : t);
}

HB_INLINE hb_triangle_foot hb_foot_at(double distance_sq, hb_vec3 a, hb_vec3 offset, int feature,
                                      int corner) {
  hb_triangle_foot foot;
  foot.distance_sq = distance_sq;
  foot.x = a.x + offset.x;
  foot.y = a.y + offset.y;
  foot.z = a.z + offset.z;
  foot.feature = feature;
  foot.corner = corner;
  return foot;
}

/* Of the triangle p0 p1 p2 to q: exact to a few roundings of the largest coordinate, for needles, caps, and
 * triangles that are a segment or a point. The answer depends on the corners' order only in its last digits.
 */
HB_INLINE hb_triangle_foot hb_nearest_of_triangle(hb_vec3 p0, hb_vec3 p1, hb_vec3 p2, hb_vec3 q) {
  /* The longest edge comes first: projecting on it keeps the error at rounding size for needles and caps. */
  const double l0 = hb_square_of(hb_minus(p1, p0)), l1 = hb_square_of(hb_minus(p2, p1)),
               l2 = hb_square_of(hb_minus(p0, p2));
  int first = 0;
  hb_vec3 a = p0, b = p1, c = p2;
  if (l1 > l0 && l1 >= l2) {
    first = 1;
    a = p1;
    b = p2;
    c = p0;
  } else if (l2 > l0) {
    first = 2;
    a = p2;
    b = p0;
    c = p1;
  }
  const hb_vec3 e0 = hb_minus(b, a), e1 = hb_minus(c, a), r = hb_minus(q, a);
  const double inv_e0 = hb_inverse_of(hb_square_of(e0)), along = hb_dot3(r, e0) * inv_e0,
               shear = hb_dot3(e1, e0) * inv_e0;
  const hb_vec3 h = hb_minus(e1, hb_times(shear, e0));
  const double inv_h = hb_inverse_of(hb_square_of(h));
  const double v = hb_dot3(hb_minus(r, hb_times(along, e0)), h) * inv_h, u = along - v * shear;
  if (inv_h > 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0) {
    const hb_vec3 offset = hb_sum_of(u, e0, v, e1);
    return hb_foot_at(hb_square_of(hb_minus(r, offset)), a, offset, 0, 0);
  }
  const hb_vec3 e2 = hb_minus(e1, e0);
  /* Shares along the edges from the first corner to the second, to the third, and from the second to the
   * third. */
  const double s0 = hb_share(along), s1 = hb_share(hb_dot3(r, e1) * hb_inverse_of(hb_square_of(e1))),
               s2 = hb_share(hb_dot3(hb_minus(r, e0), e2) * hb_inverse_of(hb_square_of(e2)));
  const hb_vec3 o0 = hb_times(s0, e0), o1 = hb_times(s1, e1), t2 = hb_times(s2, e2);
  hb_vec3 offset = o0, o2;
  o2.x = e0.x + t2.x;
  o2.y = e0.y + t2.y;
  o2.z = e0.z + t2.z;
  double nearest_sq = hb_square_of(hb_minus(r, o0)), share = s0;
  int edge = 0, from = 0, to = 1;
  const double sq1 = hb_square_of(hb_minus(r, o1)), sq2 = hb_square_of(hb_minus(r, o2));
  if (sq1 < nearest_sq) {
    nearest_sq = sq1;
    offset = o1;
    share = s1;
    edge = 2;
    from = 0;
    to = 2;
  }
  if (sq2 < nearest_sq) {
    nearest_sq = sq2;
    offset = o2;
    share = s2;
    edge = 1;
    from = 1;
    to = 2;
  }
  const int inside = share > 0.0 && share < 1.0;
  const int corner = first + (inside ? edge : (share > 0.0 ? to : from));
  return hb_foot_at(nearest_sq, a, offset, inside ? 1 : 2, corner < 3 ? corner : corner - 3);
}

#endif
