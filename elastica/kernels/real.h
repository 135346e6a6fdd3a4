/* The number type and the few operations that the kernels are written in: the common subset of C, C++ and
 * OpenCL C.
 *
 * A user may define HB_REAL and the operations before including a kernel, for instance as a SIMD vector
 * (elastica/kernels/simd_lanes.h). Defaults: double, C library. HB_SELECT(c, a, b) is a where c holds and b
 * elsewhere, both being evaluated; c comes from comparing HB_REALs. HB_ANY(c) asks whether it holds in any
 * lane. HB_ABOUT_RSQRT(a) is within 4e-4 of itself for a from 1e-30 to 1e30, without dividing where that is
 * slow. HB_GLOBAL stands before data that lie in a device's memory. */
#ifndef HOTBLADE_ELASTICA_KERNELS_REAL_H
#define HOTBLADE_ELASTICA_KERNELS_REAL_H

#ifdef __OPENCL_VERSION__
#define HB_CONSTANT __constant
#define HB_GLOBAL __global
#define HB_INLINE static inline
#else
#define HB_CONSTANT static const
#define HB_GLOBAL
#define HB_INLINE static inline __attribute__((always_inline))
#endif

#ifndef HB_REAL
#define HB_REAL double
#ifdef __OPENCL_VERSION__
#define HB_SQRT(a) sqrt(a)
#else
#include <math.h>
#define HB_SQRT(a) __builtin_sqrt(a)
#endif
/* a b + c, fused where that is one instruction. */
#define HB_FMA(a, b, c) ((a) * (b) + (c))
#define HB_RSQRT(a) (1.0 / HB_SQRT(a))
#define HB_RECIPROCAL(a) (1.0 / (a))
#define HB_BROADCAST(a) ((HB_REAL)(a))
#define HB_MASK int
#define HB_NOT(m) (!(m))
#define HB_ANY(m) (m)
#endif

#ifndef HB_ABOUT_RSQRT
#define HB_ABOUT_RSQRT(a) HB_RSQRT(a)
#endif

#define HB_SELECT(c, a, b) ((c) ? (a) : (b))
#define HB_ABS(a) HB_SELECT((a) < HB_BROADCAST(0.0), -(a), (a))
/* The larger and the smaller of both; b where either is NaN. */
#ifndef HB_MAX
#define HB_MAX(a, b) HB_SELECT((a) > (b), (a), (b))
#define HB_MIN(a, b) HB_SELECT((a) < (b), (a), (b))
#endif

#endif
