// Elliptic functions and lambda-residuals in bulk, each beside its reference and beside what a core can do,
// all measured in the same run. Counters: `times` is the ratio to the reference, `share` that of the core's
// peak in flops.
#include <benchmark/benchmark.h>

#ifdef __x86_64__
#include <immintrin.h>
#endif

#include <boost/math/special_functions/ellint_2.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <ctime>
#include <random>
#include <vector>

#include "elastica/bezier/residual_batch.hpp"
#include "elastica/curve/closed_form.hpp"
#include "tests/bench/plain_residuals.hpp"
#include "tests/elastica/bezier/residual_cubics.hpp"

namespace {

using namespace hotblade::elastica;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Items a second of CPU time, the best of five stretches: other programs only slow it down.
template <typename Work>
double best_rate(double items, const Work& work) {
  constexpr double kStretch = 0.03;
  double best = 0;
  for (int i = 0; i < 5; ++i) {
    double done = 0;
    const double start = cpu_seconds();
    do {
      work();
      done += items;
    } while (cpu_seconds() - start < kStretch);
    best = std::max(best, done / (cpu_seconds() - start));
  }
  return best;
}

#ifdef __x86_64__
// Twelve chains of fused multiply-adds: more than latency times ports.
#define HOTBLADE_PEAK(name, isa, vector, set, fma)                                                   \
  __attribute__((target(isa))) double name() {                                                       \
    constexpr int kRounds = 20000;                                                                   \
    vector a[12], m = set(0.999999), c = set(1e-6);                                                  \
    for (int i = 0; i < 12; ++i) a[i] = set(1.0 + i);                                                \
    const double rate = best_rate(                                                                   \
        12.0 * kRounds * 2 * (sizeof(vector) / sizeof(double)), [&]() __attribute__((target(isa))) { \
          vector b0 = a[0], b1 = a[1], b2 = a[2], b3 = a[3], b4 = a[4], b5 = a[5];                   \
          vector b6 = a[6], b7 = a[7], b8 = a[8], b9 = a[9], b10 = a[10], b11 = a[11];               \
          for (int i = 0; i < kRounds; ++i) {                                                        \
            b0 = fma(b0, m, c), b1 = fma(b1, m, c), b2 = fma(b2, m, c), b3 = fma(b3, m, c);          \
            b4 = fma(b4, m, c), b5 = fma(b5, m, c), b6 = fma(b6, m, c), b7 = fma(b7, m, c);          \
            b8 = fma(b8, m, c), b9 = fma(b9, m, c), b10 = fma(b10, m, c), b11 = fma(b11, m, c);      \
          }                                                                                          \
          a[0] = b0, a[1] = b1, a[2] = b2, a[3] = b3, a[4] = b4, a[5] = b5;                          \
          a[6] = b6, a[7] = b7, a[8] = b8, a[9] = b9, a[10] = b10, a[11] = b11;                      \
          benchmark::DoNotOptimize(a);                                                               \
        });                                                                                          \
    return rate;                                                                                     \
  }
HOTBLADE_PEAK(peak_avx512, "avx512f", __m512d, _mm512_set1_pd, _mm512_fmadd_pd)
HOTBLADE_PEAK(peak_avx2, "avx2,fma", __m256d, _mm256_set1_pd, _mm256_fmadd_pd)
#endif

// Flop/s against the core's own peak in double precision, for the instruction set in use; the baseline has no
// fused operation to measure it by.
void count_share(benchmark::State& state, Simd simd, double flops) {
#ifdef __x86_64__
  if (simd == Simd::kBaseline) return;
  const double peak = simd == Simd::kAvx512 ? peak_avx512() : peak_avx2();
  state.counters["share_of_peak"] = flops / peak;
  state.counters["peak_GFLOPs"] = peak / 1e9;
#else
  (void)state, (void)simd, (void)flops;
#endif
}

Simd simd_of(benchmark::State& state) {
  const auto simd = static_cast<Simd>(state.range(0));
  if (!supported(simd)) state.SkipWithError("this machine lacks the instruction set");
  return simd;
}

constexpr std::size_t kCount = 4096;

// Counted in elastica/kernels: 45 for the sine and cosine, 21 a level, 4 at the end; a fused operation is
// two.
double flops_of_jacobi(int levels) {
  return 49 + 21.0 * levels;
}

void EllipticSamples(benchmark::State& state) {
  const Simd simd = simd_of(state);
  if (state.error_occurred()) return;
  const double k = static_cast<double>(state.range(1)) / 1e6;
  const Jacobi jacobi(k);
  std::vector<double> u(kCount), sn(kCount), cn(kCount), dn(kCount), e(kCount);
  for (std::size_t i = 0; i < kCount; ++i) u[i] = 3 * jacobi.period() * static_cast<double>(i) / kCount;
  const auto ours = [&] {
    jacobi.sample(u, {sn, cn, dn, e}, simd);
    benchmark::DoNotOptimize(e.data());
    benchmark::ClobberMemory();
  };
  for (auto _ : state) ours();
  const auto boost = [&] {
    double sum = 0;
    for (std::size_t i = 0; i < 64; ++i) {
      double c = 0, d = 0;
      // Above 1 by the reciprocal modulus, as Boost's own domain asks.
      const double s = k > 1 ? boost::math::jacobi_elliptic(1 / k, k * u[64 * i], &c, &d)
                             : boost::math::jacobi_elliptic(k, u[64 * i], &c, &d);
      sum += boost::math::ellint_2(std::min(k, 1 / k), std::atan2(s, c));
    }
    benchmark::DoNotOptimize(sum);
  };
  const double rate = best_rate(kCount, ours);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
  state.counters["times_Boost"] = rate / best_rate(64, boost);
  count_share(state, simd, rate * flops_of_jacobi(jacobi.levels()));
}
BENCHMARK(EllipticSamples)
    ->ArgNames({"simd", "millionths_of_k"})
    ->ArgsProduct({{0, 1, 2}, {100'000, 700'000, 990'000, 999'999, 1'500'000, 1'000'000'000}});

// 51 a node and 200 a curve, counted in elastica/kernels; a fused operation is two.
constexpr double kResidualFlops = 24 * 51 + 200;

enum Cubics { kOrdinary, kAnything, kNearCusps };

// Columns x0 y0 .. x3 y3: like ribs, control points anywhere in a square, and with a speed of 1e-6 to 1
// inside.
std::vector<std::vector<double>> cubic_columns(Cubics kind) {
  RandomCubics random(1);
  std::vector<std::vector<double>> c(8, std::vector<double>(kCount));
  for (std::size_t i = 0; i < kCount; ++i) {
    const Bezier b = kind == kOrdinary   ? random.ordinary()
                     : kind == kAnything ? random.anything()
                                         : random.near_cusp();
    for (std::size_t k = 0; k < 8; ++k) c[k][i] = b[k / 2][static_cast<Eigen::Index>(k % 2)];
  }
  return c;
}

// `times_24_nodes` is the time beside that of 24 nodes without a bound, which only ordinary cubics do with.
void ResidualBatches(benchmark::State& state) {
  const Simd simd = simd_of(state);
  if (state.error_occurred()) return;
  const auto c = cubic_columns(static_cast<Cubics>(state.range(1)));
  std::vector<double> e(kCount), bound(kCount);
  std::vector<ResidualStatus> status(kCount);
  const auto ours = [&] {
    lambda_residuals({c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]}, {e, status, bound}, simd);
    benchmark::DoNotOptimize(e.data());
    benchmark::ClobberMemory();
  };
  for (auto _ : state) ours();
  const auto scalar = [&] {
    double sum = 0;
    for (std::size_t i = 0; i < 256; ++i) {
      sum +=
          lambda_residual(
              {Eigen::Vector2d(c[0][i], c[1][i]), {c[2][i], c[3][i]}, {c[4][i], c[5][i]}, {c[6][i], c[7][i]}})
              .value;
    }
    benchmark::DoNotOptimize(sum);
  };
  const double* in[8];
  for (std::size_t k = 0; k < 8; ++k) in[k] = c[k].data();
  const auto plain = [&] {
    (simd == Simd::kAvx512 ? plain_residuals_avx512
     : simd == Simd::kAvx2 ? plain_residuals_avx2
                           : plain_residuals_baseline)(in, e.data(), kCount);
    benchmark::DoNotOptimize(e.data());
    benchmark::ClobberMemory();
  };
  const double rate = best_rate(kCount, ours), plain_rate = best_rate(kCount, plain);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
  state.counters["times_scalar"] = rate / best_rate(256, scalar);
  state.counters["times_24_nodes"] = plain_rate / rate;
  count_share(state, simd, plain_rate * kResidualFlops);
}
BENCHMARK(ResidualBatches)
    ->ArgNames({"simd", "ordinary_anything_cusps"})
    ->ArgsProduct({{0, 1, 2}, {0, 1, 2}});

void ResidualGradients(benchmark::State& state) {
  const Simd simd = simd_of(state);
  if (state.error_occurred()) return;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(-3, 3), length(0.2, 1.5);
  std::vector<double> a1(kCount), a2(kCount), l1(kCount), l2(kCount), e(kCount), by_l1(kCount), by_l2(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    a1[i] = angle(random);
    a2[i] = angle(random);
    l1[i] = length(random);
    l2[i] = length(random);
  }
  std::vector<ResidualStatus> status(kCount);
  for (auto _ : state) {
    lambda_residual_gradients({a1, a2, l1, l2}, {e, status}, by_l1, by_l2, simd);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kCount));
}
BENCHMARK(ResidualGradients)->ArgName("simd")->DenseRange(0, 2);

}  // namespace
