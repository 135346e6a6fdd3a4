// Compiled for one instruction set; see CMakeLists.txt.
#include "elastica/residual_kernels.hpp"
// Lanes first.
#include "elastica/blade_droop_kernels.hpp"
#include "elastica/blade_margin_kernels.hpp"
#include "elastica/closed_form_kernels.hpp"

namespace hotblade::elastica {

const ResidualKernels kResidualBaseline = kResidualKernels;
const ClosedFormKernels kClosedFormBaseline = kClosedFormKernels;
const BladeKernels kBladeBaseline = {even_points, stability_margins_of, droops_of};

}  // namespace hotblade::elastica
