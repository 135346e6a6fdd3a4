#include "elastica/kernels/simd_pin.hpp"

#include <array>
#include <stdexcept>
#include <string>

namespace hotblade::elastica {

std::string_view name(Simd simd) {
  if (simd == Simd::kAvx512) return "avx512";
  return simd == Simd::kAvx2 ? "avx2" : "baseline";
}

Simd simd_named(std::string_view wanted) {
  constexpr std::array kWidestFirst{Simd::kAvx512, Simd::kAvx2, Simd::kBaseline};
  for (const Simd simd : kWidestFirst) {
    if (wanted.empty() && supported(simd)) return simd;
    if (wanted != name(simd)) continue;
    if (supported(simd)) return simd;
    throw std::runtime_error("HOTBLADE_SIMD: this machine does not run " + std::string(wanted) +
                             ": it runs " + std::string(name(simd_named(""))) + ", name that or a lower one");
  }
  throw std::runtime_error("HOTBLADE_SIMD: no instruction set has this name (" + std::string(wanted) +
                           "): give baseline, avx2 or avx512");
}

}  // namespace hotblade::elastica
