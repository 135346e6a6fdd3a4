// The interface between closed_form.cpp and its sources per instruction set: plain arrays of n values;
// outputs may be null.
#pragma once

#include <stddef.h>

#include "elastica/kernels/jacobi.h"

namespace hotblade::elastica {

struct JacobiLanes {
  const double* u;
  double *sn, *cn, *dn, *e;
};

struct CurveLanes {
  const double* s;
  double *x, *y, *tangent_x, *tangent_y, *kappa;
};

struct ClosedFormKernels {
  void (*jacobi)(const hb_ladder& ladder, double modulus, const JacobiLanes& batch, size_t n);
  void (*curve)(const hb_ladder& ladder, const hb_closed_form& form, const CurveLanes& batch, size_t n);
};

// All three are the baseline where the target is not x86-64.
extern const ClosedFormKernels kClosedFormBaseline, kClosedFormAvx2, kClosedFormAvx512;

}  // namespace hotblade::elastica
