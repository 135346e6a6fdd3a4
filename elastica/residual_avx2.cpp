// Compiled for one instruction set; see CMakeLists.txt.
#include "elastica/residual_kernels.hpp"

namespace hotblade::elastica {

const ResidualKernels kResidualAvx2 = kResidualKernels;

}  // namespace hotblade::elastica
