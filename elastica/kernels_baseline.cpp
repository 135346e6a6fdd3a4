// Compiled for one instruction set; see CMakeLists.txt.
#include "elastica/residual_kernels.hpp"
// Lanes first.
#include "elastica/closed_form_kernels.hpp"

namespace hotblade::elastica {

const ResidualKernels kResidualBaseline = kResidualKernels;
const ClosedFormKernels kClosedFormBaseline = kClosedFormKernels;

}  // namespace hotblade::elastica
