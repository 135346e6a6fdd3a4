// Compiled for one instruction set; see CMakeLists.txt.
#include "tests/bench/plain_residual_kernels.hpp"

void plain_residuals_baseline(const double* const* in, double* e, size_t n) {
  residuals_by_24_nodes(in, e, n);
}
