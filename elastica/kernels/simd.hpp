// Which instruction set the batch kernels run on: chosen at run time, the same program runs on every x86-64
// (and, with the baseline, elsewhere). Results of different instruction sets differ by rounding only.
#pragma once

namespace hotblade::elastica {

enum class Simd { kBaseline, kAvx2, kAvx512 };

// Whether this machine and operating system run it; kAvx2 asks for FMA too, kAvx512 for F, DQ and VL.
[[nodiscard]] bool supported(Simd simd);

// The widest instruction set that is supported.
[[nodiscard]] Simd best_simd();

}  // namespace hotblade::elastica
