// HB_REAL as a SIMD vector, for the instruction set this source is compiled for: 8 doubles with AVX-512, 4
// with AVX2 and FMA, else 2. Include before any kernel.
//
// Only for sources that are compiled once per instruction set. Everything here and in the kernels is static,
// and such a source includes nothing with inline functions of external linkage: the linker would keep one
// copy of them, of any instruction set.
#pragma once

#include <stddef.h>
#include <string.h>

#ifdef __x86_64__
#include <immintrin.h>
#endif

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#define HB_LANES 8
#elif defined(__AVX2__) && defined(__FMA__)
#define HB_LANES 4
#else
#define HB_LANES 2
#endif

typedef double hb_lanes __attribute__((vector_size(8 * HB_LANES)));
typedef long long hb_lanes_mask __attribute__((vector_size(8 * HB_LANES)));

#define HB_REAL hb_lanes
#define HB_MASK hb_lanes_mask
#define HB_NOT(m) (~(m))

#if HB_LANES == 8
#define HB_BROADCAST(a) ((hb_lanes)_mm512_set1_pd(a))
#define HB_SQRT(a) ((hb_lanes)_mm512_sqrt_pd((__m512d)(a)))
#define HB_FMA(a, b, c) ((hb_lanes)_mm512_fmadd_pd((__m512d)(a), (__m512d)(b), (__m512d)(c)))
// The 14 bits of the instruction, squared by one series step of fourth order: y (1 + h/2 + 3 h^2/8 + 5
// h^3/16) with h = 1 - a y^2, whose next term is 35/128 h^4 < 2^-55.
static inline __attribute__((always_inline)) hb_lanes hb_rsqrt(hb_lanes a) {
  const hb_lanes y = (hb_lanes)_mm512_rsqrt14_pd((__m512d)a);
  const hb_lanes h = HB_FMA(-(a * y), y, HB_BROADCAST(1.0));
  hb_lanes p = HB_FMA(h, HB_BROADCAST(0.3125), HB_BROADCAST(0.375));
  p = HB_FMA(p, h, HB_BROADCAST(0.5));
  return HB_FMA(y * h, p, y);
}
#define HB_RSQRT(a) hb_rsqrt(a)
#define HB_ABOUT_RSQRT(a) ((hb_lanes)_mm512_rsqrt14_pd((__m512d)(a)))
// Fourth order too: y (1 + h + h^2 + h^3) with h = 1 - a y.
static inline __attribute__((always_inline)) hb_lanes hb_reciprocal(hb_lanes a) {
  const hb_lanes y = (hb_lanes)_mm512_rcp14_pd((__m512d)a);
  const hb_lanes h = HB_FMA(-a, y, HB_BROADCAST(1.0));
  return HB_FMA(HB_FMA(HB_FMA(h, h, h), h, h), y, y);
}
#define HB_RECIPROCAL(a) hb_reciprocal(a)
#define HB_MAX(a, b) ((hb_lanes)_mm512_max_pd((__m512d)(a), (__m512d)(b)))
#define HB_MIN(a, b) ((hb_lanes)_mm512_min_pd((__m512d)(a), (__m512d)(b)))
#define HB_ANY(m) (_mm512_movepi64_mask((__m512i)(m)) != 0)
#elif HB_LANES == 4
#define HB_BROADCAST(a) ((hb_lanes)_mm256_set1_pd(a))
#define HB_SQRT(a) ((hb_lanes)_mm256_sqrt_pd((__m256d)(a)))
#define HB_FMA(a, b, c) ((hb_lanes)_mm256_fmadd_pd((__m256d)(a), (__m256d)(b), (__m256d)(c)))
#define HB_RSQRT(a) (HB_BROADCAST(1.0) / HB_SQRT(a))
#define HB_RECIPROCAL(a) (HB_BROADCAST(1.0) / (a))
#define HB_ABOUT_RSQRT(a) ((hb_lanes)_mm256_cvtps_pd(_mm_rsqrt_ps(_mm256_cvtpd_ps((__m256d)(a)))))
#define HB_MAX(a, b) ((hb_lanes)_mm256_max_pd((__m256d)(a), (__m256d)(b)))
#define HB_MIN(a, b) ((hb_lanes)_mm256_min_pd((__m256d)(a), (__m256d)(b)))
#define HB_ANY(m) (_mm256_movemask_pd((__m256d)(m)) != 0)
#else
static inline __attribute__((always_inline)) hb_lanes hb_both(double a) {
  return hb_lanes{a, a};
}
#define HB_BROADCAST(a) hb_both(a)
#ifdef __SSE2__
#define HB_SQRT(a) ((hb_lanes)_mm_sqrt_pd((__m128d)(a)))
#define HB_ABOUT_RSQRT(a) ((hb_lanes)_mm_cvtps_pd(_mm_rsqrt_ps(_mm_cvtpd_ps((__m128d)(a)))))
#else
#define HB_SQRT(a)                                 \
  hb_lanes {                                       \
    __builtin_sqrt((a)[0]), __builtin_sqrt((a)[1]) \
  }
#endif
#define HB_FMA(a, b, c) ((a) * (b) + (c))
#define HB_RSQRT(a) (HB_BROADCAST(1.0) / HB_SQRT(a))
#define HB_RECIPROCAL(a) (HB_BROADCAST(1.0) / (a))
#define HB_ANY(m) (((m)[0] | (m)[1]) != 0)
#endif

// Lanes from and to arrays of `count` <= HB_LANES values; missing ones repeat the last, so that they cost and
// raise nothing of their own.
static inline __attribute__((always_inline)) hb_lanes hb_load(const double* from, size_t count) {
  hb_lanes v;
  if (count == HB_LANES) {
    memcpy(&v, from, sizeof v);
  } else {
    for (size_t i = 0; i < HB_LANES; ++i) v[i] = from[i < count ? i : count - 1];
  }
  return v;
}

static inline __attribute__((always_inline)) void hb_store(double* to, hb_lanes v, size_t count) {
  if (count == HB_LANES) {
    memcpy(to, &v, sizeof v);
  } else {
    for (size_t i = 0; i < count; ++i) to[i] = v[i];
  }
}
