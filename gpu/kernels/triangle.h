// Computes point to triangle in single precision, in the common subset of C, C++ and OpenCL C: REAL is float, or in C++
// a vector of floats, one triangle a lane.
//
// A triangle lies in a frame of its own, computed in double precision: origin in one end of its longest edge,
// x along that edge, y to the third corner, z = x cross y. There its corners are (0,0), (base,0), (foot,rise)
// with 0 <= foot <= base, and no quotient of nearly equal numbers is left for single precision: a needle loses
// no more than an equilateral triangle. mesh_tree.h bounds what is lost.
#ifndef HOTBLADE_GPU_KERNELS_TRIANGLE_H
#define HOTBLADE_GPU_KERNELS_TRIANGLE_H

// Squared distance in the plane from (x, y) to the segment from the origin to (ex, ey), inv = 1 / (ex^2 + ey^2)
// or 0 for a point.
#define HOTBLADE_SEGMENT_SQ(out, x, y, ex, ey, inv) \
  {                                                 \
    REAL t_ = ((x) * (ex) + (y) * (ey)) * (inv);    \
    t_ = t_ < 0.0f ? t_ * 0.0f : t_;                \
    t_ = t_ > 1.0f ? t_ * 0.0f + 1.0f : t_;         \
    const REAL dx_ = (x)-t_ * (ex);                 \
    const REAL dy_ = (y)-t_ * (ey);                 \
    out = dx_ * dx_ + dy_ * dy_;                    \
  }

// Squared distance from r = point - origin to the triangle with axes u, v. NaN in, NaN out.
static inline REAL triangle_distance_sq(REAL rx, REAL ry, REAL rz, REAL ux, REAL uy, REAL uz, REAL vx, REAL vy,
                                        REAL vz, REAL base, REAL foot, REAL rise, REAL inv_left,
                                        REAL inv_right) {
  const REAL x = rx * ux + ry * uy + rz * uz;
  const REAL y = rx * vx + ry * vy + rz * vz;
  const REAL z = rx * (uy * vz - uz * vy) + ry * (uz * vx - ux * vz) + rz * (ux * vy - uy * vx);
  const REAL past = x - base;
  // Below the base, with acute angles at both its ends, the base is nearest.
  REAL along = x < 0.0f ? x : x * 0.0f;
  along = past > 0.0f ? past : along;
  const REAL below_sq = along * along + y * y;
  REAL left_sq, right_sq;
  HOTBLADE_SEGMENT_SQ(left_sq, x, y, foot, rise, inv_left)
  const REAL back = foot - base;
  HOTBLADE_SEGMENT_SQ(right_sq, past, y, back, rise, inv_right)
  REAL plane_sq = left_sq < right_sq ? left_sq : right_sq;
  const REAL inside_left = rise * x - foot * y;
  const REAL inside_right = back * y - rise * past;
  // Strict, so that a triangle without area has no inside.
  plane_sq = inside_left > 0.0f ? (inside_right > 0.0f ? plane_sq * 0.0f : plane_sq) : plane_sq;
  plane_sq = y > 0.0f ? plane_sq : below_sq;
  return plane_sq + z * z;
}

#endif
