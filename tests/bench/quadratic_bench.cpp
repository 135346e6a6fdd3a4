// Quadratic Beziers: closed forms, nearest point, tangent curves; on one core.
#include <benchmark/benchmark.h>

#include <random>

#include "elastica/quadratic/quadratic.hpp"
#include "elastica/quadratic/quadratic_tangent.hpp"

namespace {

using namespace hotblade::elastica;
using Eigen::Vector2d;

std::vector<Quadratic> random_quadratics() {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Quadratic> curves(1000);
  for (Quadratic& q : curves) {
    for (Vector2d& p : q) p = {u(random), u(random)};
  }
  return curves;
}

template <typename F>
void each(benchmark::State& state, const F& f) {
  const auto curves = random_quadratics();
  for (auto _ : state) {
    for (const Quadratic& q : curves) benchmark::DoNotOptimize(f(q));
  }
  state.SetItemsProcessed(state.iterations() * 1000);
}

void QuadraticLength(benchmark::State& state) {
  each(state, [](const Quadratic& q) { return length(q); });
}
BENCHMARK(QuadraticLength);

void QuadraticEnergy(benchmark::State& state) {
  each(state, [](const Quadratic& q) { return energy(q); });
}
BENCHMARK(QuadraticEnergy);

void QuadraticNearestPoint(benchmark::State& state) {
  each(state, [](const Quadratic& q) { return nearest(q, {0.3, -0.1}); });
}
BENCHMARK(QuadraticNearestPoint);

// The paper's problem: both ends outside. Its rates in 2014: 2000, 2000, 1400, 1290 solves a second; with
// level sets 340, 300, 300, 275.
void Tangent(benchmark::State& state, bool circle, Objective objective, int level_points) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(-2, 2), height(1.01, 3);
  for (auto _ : state) {
    const Vector2d b0{u(random), height(random)}, b2{u(random), height(random)};
    const TangentCurves c = circle ? tangent_to_circle(b0, b2, {0, 0}, 1, objective)
                                   : tangent_to_line(b0, b2, {0, 0}, {1, 0}, objective);
    benchmark::DoNotOptimize(c);
    if (level_points == 0) continue;
    const double value = c.minima[c.best].value;
    benchmark::DoNotOptimize(objective == Objective::kLength ? length_level_set(b0, b2, value, level_points)
                                                             : energy_level_set(b0, b2, value, level_points));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK_CAPTURE(Tangent, LineLength, false, Objective::kLength, 0);
BENCHMARK_CAPTURE(Tangent, LineEnergy, false, Objective::kEnergy, 0);
BENCHMARK_CAPTURE(Tangent, CircleLength, true, Objective::kLength, 0);
BENCHMARK_CAPTURE(Tangent, CircleEnergy, true, Objective::kEnergy, 0);
BENCHMARK_CAPTURE(Tangent, LineLengthWithLevelSet, false, Objective::kLength, 256);
BENCHMARK_CAPTURE(Tangent, LineEnergyWithLevelSet, false, Objective::kEnergy, 256);
BENCHMARK_CAPTURE(Tangent, CircleLengthWithLevelSet, true, Objective::kLength, 256);
BENCHMARK_CAPTURE(Tangent, CircleEnergyWithLevelSet, true, Objective::kEnergy, 256);

}  // namespace
