// Compiled for one instruction set; see elastica/CMakeLists.txt.
#include "elastica/blade/blade_droop_kernels.hpp"
#include "elastica/blade/blade_margin_kernels.hpp"

namespace hotblade::elastica {

const BladeKernels kBladeAvx2 = {even_points, stability_margins_of, droops_of};

}  // namespace hotblade::elastica
