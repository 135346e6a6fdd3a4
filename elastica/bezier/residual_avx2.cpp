// Compiled for one instruction set; see elastica/CMakeLists.txt.
#include "elastica/bezier/residual_kernels.hpp"

namespace hotblade::elastica {

const ResidualKernels kResidualAvx2 = kResidualKernels;

}  // namespace hotblade::elastica
