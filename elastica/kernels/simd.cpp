#include "elastica/kernels/simd.hpp"

#include <cstdlib>

#include "elastica/kernels/simd_pin.hpp"

namespace hotblade::elastica {

bool supported(Simd simd) {
#ifdef __x86_64__
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  switch (simd) {
    case Simd::kBaseline:
      return true;
    case Simd::kAvx2:
      return avx2;
    case Simd::kAvx512:
      return avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl");
  }
#endif
  return simd == Simd::kBaseline;
}

Simd best_simd() {
  static const Simd best = [] {
    const char* pin = std::getenv("HOTBLADE_SIMD");
    return simd_named(pin != nullptr ? pin : "");
  }();
  return best;
}

}  // namespace hotblade::elastica
