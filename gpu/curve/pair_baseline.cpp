// Compiled for one instruction set; see CMakeLists.txt.
#include "gpu/curve/pair_lane_kernels.h"

namespace hotblade::gpu {

const PairLanes kPairBaseline = {differences_of_pairs, hausdorff_of_pairs};

}  // namespace hotblade::gpu
