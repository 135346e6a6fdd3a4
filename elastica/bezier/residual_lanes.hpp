// The interface between residual_batch.cpp and its sources per instruction set: plain arrays of n values
// each.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace hotblade::elastica {

struct ResidualLanes {
  // x0 y0 .. x3 y3, or a1 a2 l1 l2; of rows the first alone, x0 y0 .. x3 y3 of a curve after the other's.
  const double* in[8];
  double* e;
  double* bound;  // or null
  uint8_t* status;
  double* by_l1;
  double* by_l2;
};

struct ResidualKernels {
  void (*curves)(const ResidualLanes& batch, size_t n);
  void (*rows)(const ResidualLanes& batch, size_t n);
  void (*edges)(const ResidualLanes& batch, size_t n);
  void (*gradients)(const ResidualLanes& batch, size_t n);
};

// All are the baseline where the target is not x86-64.
extern const ResidualKernels kResidualBaseline, kResidualAvx2, kResidualAvx512;

}  // namespace hotblade::elastica
