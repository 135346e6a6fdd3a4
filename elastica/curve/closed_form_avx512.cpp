// Compiled for one instruction set; see elastica/CMakeLists.txt.
#include "elastica/curve/closed_form_kernels.hpp"

namespace hotblade::elastica {

const ClosedFormKernels kClosedFormAvx512 = kClosedFormKernels;

}  // namespace hotblade::elastica
