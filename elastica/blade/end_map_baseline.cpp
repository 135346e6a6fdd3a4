// Compiled for one instruction set; see elastica/CMakeLists.txt.
#include "elastica/blade/end_map_kernels.hpp"

namespace hotblade::elastica {

const EndMapKernels kEndMapBaseline = kKernels;

}  // namespace hotblade::elastica
