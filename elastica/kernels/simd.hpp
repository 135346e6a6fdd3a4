// Which instruction set the batch kernels run on: chosen at run time, the same program runs on every x86-64
// (and, with the baseline, elsewhere). Results of different instruction sets differ by rounding only.
#pragma once

namespace hotblade::elastica {

enum class Simd { kBaseline, kAvx2, kAvx512 };

// Whether this machine and operating system run it; kAvx2 asks for FMA too, kAvx512 for F, DQ and VL.
[[nodiscard]] bool supported(Simd simd);

// HOTBLADE_SIMD's (elastica/kernels/simd_pin.hpp), else the widest that is supported; asked once.
[[nodiscard]] Simd best_simd();

}  // namespace hotblade::elastica
