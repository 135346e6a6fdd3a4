#include "gpu/mesh/mesh_search_kernels.h"

namespace hotblade::gpu {

MeshSearch mesh_search_baseline() {
  return {search_tree, find_entry};
}

MeshSearch mesh_search() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return mesh_search_avx2();
#endif
  return mesh_search_baseline();
}

}  // namespace hotblade::gpu
