// Compiled for one instruction set; see CMakeLists.txt.
#include "gpu/curve/curve_lane_kernels.h"

namespace hotblade::gpu {

const CurveLanes kCurveAvx512 = {on_whole, on_pieces, residuals_of_curves};

}  // namespace hotblade::gpu
