// The instruction set by name, as the environment's HOTBLADE_SIMD pins it: machines of different processors
// that are given the same one get the same results.
#pragma once

#include <string_view>

#include "elastica/kernels/simd.hpp"

namespace hotblade::elastica {

// Returns its name: baseline, avx2 or avx512.
[[nodiscard]] std::string_view name(Simd simd);

// Returns the instruction set of this name; of an empty name the widest that is supported. Throws
// std::runtime_error when there is none of this name, or this machine does not run it.
[[nodiscard]] Simd simd_named(std::string_view wanted);

}  // namespace hotblade::elastica
