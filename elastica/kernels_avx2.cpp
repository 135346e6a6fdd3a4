// Compiled for one instruction set; see CMakeLists.txt.
#include "elastica/residual_kernels.hpp"
// Lanes first.
#include "elastica/blade_droop_kernels.hpp"
#include "elastica/blade_margin_kernels.hpp"
#include "elastica/closed_form_kernels.hpp"

namespace hotblade::elastica {

const ResidualKernels kResidualAvx2 = kResidualKernels;
const ClosedFormKernels kClosedFormAvx2 = kClosedFormKernels;
const BladeKernels kBladeAvx2 = {even_points, stability_margins_of, droops_of};

}  // namespace hotblade::elastica
