// The lambda-residuals of many cubics, one work item a curve: elastica/kernels/graded_residual.h with one
// lane.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

#include "elastica/kernels/graded_residual.h"

// curves: x0 y0 .. x3 y3 of each; answers: e, status and bound of each, and a number that says nothing.
__kernel void lambda_residuals(__global const double8* curves, __global double4* answers, const int count) {
  const int id = (int)get_global_id(0);
  if (id >= count) return;
  const double8 c = curves[id];
  hb_legs legs;
  legs.x1 = c.s2 - c.s0;
  legs.y1 = c.s3 - c.s1;
  legs.x2 = c.s4 - c.s0;
  legs.y2 = c.s5 - c.s1;
  legs.x3 = c.s6 - c.s0;
  legs.y3 = c.s7 - c.s1;
  const hb_residual r = hb_lambda_residual(&legs);
  answers[id] = (double4)(r.e, r.status, r.bound, 0.0);
}
