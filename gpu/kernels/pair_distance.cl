// Cubic Beziers against elastica, one work item a pair: elastica/kernels/curve_pair.h with one lane. OpenCL C rounds
// double +, -, *, / and sqrt as IEEE 754 says, and nothing is fused, so the bits are those of the host's lanes.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

#include "elastica/kernels/curve_pair.h"

// The numbers of a pair as gpu/curve/pair_lanes.hpp orders them.
static hb_pair pair_at(__global const double16* pairs, int id) {
  const double16 v = pairs[id];
  hb_pair pair;
  pair.x0 = v.s0;
  pair.x1 = v.s1;
  pair.x2 = v.s2;
  pair.x3 = v.s3;
  pair.y0 = v.s4;
  pair.y1 = v.s5;
  pair.y2 = v.s6;
  pair.y3 = v.s7;
  pair.field.k = v.s8;
  pair.field.l1 = v.s9;
  pair.field.l2 = v.sa;
  pair.field.most_step = v.sb;
  pair.start.x = 0.0;
  pair.start.y = 0.0;
  pair.start.c = v.sc;
  pair.start.s = v.sd;
  pair.length = v.se;
  pair.bend = v.sf;
  return pair;
}

// answers: L2, H1 and the Bezier's length.
__kernel void pair_differences(const int panels, __global const double16* pairs, __global double* answers,
                               const int count) {
  const int id = (int)get_global_id(0);
  if (id >= count) return;
  const hb_pair pair = pair_at(pairs, id);
  const hb_pair_difference d = hb_pair_differences(&pair, panels);
  answers[3 * id] = d.l2;
  answers[3 * id + 1] = d.h1;
  answers[3 * id + 2] = d.length;
}

// answers: lower and upper bound of the Hausdorff distance; nodes: samples + 3 a pair, those of all pairs side by side.
__kernel void pair_hausdorff(const int samples, __global const double16* pairs, __global double2* answers,
                             const int count, __global hb_pair_node* nodes) {
  const int id = (int)get_global_id(0);
  if (id >= count) return;
  const hb_pair pair = pair_at(pairs, id);
  const hb_pair_bounds b = hb_pair_hausdorff(&pair, samples, nodes + id, count);
  answers[id] = (double2)(b.lower, b.upper);
}
