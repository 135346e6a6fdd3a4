// Eight doubles at a time, whatever the instruction set: the compiler makes of each operation as many vector
// instructions as the set needs, so results are the same to the bit on all of them. For bodies that are
// always inlined, each into one function per instruction set (gnu::target).
#pragma once

#include <vector>

namespace hotblade::elastica::lanes {

inline constexpr int kLanes = 8;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using Mask = long __attribute__((vector_size(kLanes * sizeof(long))));

// Lanes in a container: the vector type alone loses its alignment as a template argument.
struct alignas(sizeof(Lanes)) Cell {
  Lanes v;
};
using Column = std::vector<Cell>;

#define HOTBLADE_INLINE [[gnu::always_inline]] inline
// The instruction sets of elastica/kernels/simd.hpp as function attributes; without FMA, which would round
// otherwise.
#define HOTBLADE_AVX2 [[gnu::target("avx2")]]
#define HOTBLADE_AVX512 [[gnu::target("avx512f,avx512dq,prefer-vector-width=512")]]

// Vectors wider than the baseline's never cross a call that is not inlined: the warning about their ABI says
// nothing.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

HOTBLADE_INLINE Lanes pick(const Mask& m, const Lanes& yes, const Lanes& no) {
  return m ? yes : no;
}

HOTBLADE_INLINE Lanes absolute(const Lanes& a) {
  return pick(a < 0, -a, a);
}

HOTBLADE_INLINE bool any(const Mask& m) {
  long found = 0;
  for (int lane = 0; lane < kLanes; ++lane) found |= m[lane];
  return found != 0;
}

#pragma GCC diagnostic pop

}  // namespace hotblade::elastica::lanes
