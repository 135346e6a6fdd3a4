// Compiled for one instruction set; see CMakeLists.txt.
#include "elastica/residual_kernels.hpp"
// Lanes first.
#include "elastica/closed_form_kernels.hpp"

namespace hotblade::elastica {

const ResidualKernels kResidualAvx512 = kResidualKernels;
const ClosedFormKernels kClosedFormAvx512 = kClosedFormKernels;

}  // namespace hotblade::elastica
