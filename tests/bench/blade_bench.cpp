// Many blades together against one by one: the points, the margin and the droop of the poses of a motion.
#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "elastica/blade/blade_batch.hpp"
#include "elastica/blade/stability.hpp"

namespace {
using namespace hotblade::elastica;

constexpr std::size_t kBlades = 256, kOneByOne = 16, kPoints = 97;
// Of a strip of 16 to 1.
constexpr StiffnessRatios kStrip{256, 1.54};

// Blades of 0.8 to 1.2 m as poses hold them, turning by up to a radian or two.
std::vector<Elastica> held_blades(std::size_t count) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Elastica> blades;
  while (blades.size() < count) {
    const double length = 1000 + 200 * u(random);
    blades.push_back({0, 0, 0.5 * u(random), u(random) / length, 4 * u(random) / (length * length),
                      4 * u(random) / (length * length), length});
  }
  return blades;
}

// The argument: an instruction set of the batch, or one by one.
constexpr std::int64_t kAlone = 3;

template <class Together, class Alone>
void many_blades(benchmark::State& state, const Together& together, const Alone& alone) {
  const bool batch = state.range(0) != kAlone;
  const auto simd = static_cast<Simd>(batch ? state.range(0) : 0);
  if (!supported(simd)) {
    state.SkipWithError("this machine lacks the instruction set");
    return;
  }
  const std::vector<Elastica> blades = held_blades(batch ? kBlades : kOneByOne);
  for (auto _ : state) {
    if (batch) {
      together(blades, simd);
    } else {
      for (const Elastica& blade : blades) alone(blade);
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(blades.size()));
}

void ManyMargins(benchmark::State& state) {
  std::vector<double> margins(kBlades);
  many_blades(
      state,
      [&](const std::vector<Elastica>& blades, Simd simd) {
        stability_margins(blades, margins, simd);
        benchmark::DoNotOptimize(margins.data());
      },
      [](const Elastica& blade) { benchmark::DoNotOptimize(stability_margin(blade)); });
}
BENCHMARK(ManyMargins)->ArgName("simd_or_3_alone")->DenseRange(0, kAlone);

void ManyDroops(benchmark::State& state) {
  constexpr double kLoad = 1e-9;
  const std::vector<DroopLoad> loads(kBlades, DroopLoad{kLoad});
  std::vector<DroopReach> reach(kBlades);
  many_blades(
      state,
      [&](const std::vector<Elastica>& blades, Simd simd) {
        droops(blades, loads, kStrip, reach, simd);
        benchmark::DoNotOptimize(reach.data());
      },
      [](const Elastica& blade) {
        const Droop one = droop(blade, kLoad, kStrip);
        benchmark::DoNotOptimize(one.largest);
      });
}
BENCHMARK(ManyDroops)->ArgName("simd_or_3_alone")->DenseRange(0, kAlone);

void ManyBladesPoints(benchmark::State& state) {
  many_blades(
      state,
      [](const std::vector<Elastica>& blades, Simd simd) {
        std::vector<Part> whole;
        whole.reserve(blades.size());
        for (const Elastica& blade : blades) whole.push_back({0, blade.length});
        const PartPoints points = sample_parts(blades, whole, kPoints, simd);
        benchmark::DoNotOptimize(points.x.begin());
      },
      [](const Elastica& blade) {
        const std::vector<CurvePoint> points = sample(blade, kPoints);
        benchmark::DoNotOptimize(points.data());
      });
}
BENCHMARK(ManyBladesPoints)->ArgName("simd_or_3_alone")->DenseRange(0, kAlone);

}  // namespace
