// Compiled for one instruction set; see CMakeLists.txt.
#include "gpu/kernels/curve_lanes.h"

namespace hotblade::gpu {

const CurveLanes kCurveBaseline = {on_whole, on_pieces, residuals_of_curves};

}  // namespace hotblade::gpu
