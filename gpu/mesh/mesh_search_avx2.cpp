// Compiled for AVX2 with fused multiply-add; see mesh_search.h for what it may include.
#include "gpu/mesh/mesh_search_kernels.h"

namespace hotblade::gpu {

MeshSearch mesh_search_avx2() {
  return {search_tree, find_entry};
}

}  // namespace hotblade::gpu
