// Compiled for one instruction set; see CMakeLists.txt.
#include "gpu/kernels/curve_lanes.h"
#include "gpu/kernels/pair_lanes.h"

namespace hotblade::gpu {

const CurveLanes kCurveAvx2 = {on_whole, on_pieces, residuals_of_curves, differences_of_pairs,
                               hausdorff_of_pairs};

}  // namespace hotblade::gpu
