// The nearest point of a curve to many points, one work item a point: curve_nearest.h with one lane.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

#include "gpu/kernels/curve_nearest.h"

// answers: distance and parameter; distance -1 where nothing is proven.
__kernel void curve_nearest(__global const hb_curve_whole* whole, const int has_whole,
                            __global const hb_curve_piece* pieces, const int pieces_count, const double sag,
                            __global const double2* points, __global double2* answers, const int count) {
  const int id = (int)get_global_id(0);
  if (id >= count) return;
  const double2 q = points[id];
  hb_curve_foot foot;
  foot.settled = 0;
  if (has_whole) foot = hb_curve_foot_on_whole(whole, q.x, q.y);
  if (!foot.settled) foot = hb_curve_foot_on_pieces(pieces, pieces_count, sag, q.x, q.y);
  answers[id] = foot.settled ? (double2)(foot.distance, foot.t) : (double2)(-1.0, 0.0);
}
