// Points to curves and residuals in bulk, one thread.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

#include "elastica/quadratic_chain.hpp"
#include "gpu/curve_distance.hpp"
#include "gpu/lambda_residuals.hpp"

namespace {

using namespace hotblade;
using Eigen::Vector2d;
using gpu::CurveDistance;

// Points over the box of the curves below, all about 1000 wide.
void points_to(benchmark::State& state, const CurveDistance& curve, std::size_t count) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(0, 1000), v(0, 300);
  std::vector<double> x(count), y(count), distance(count), t(count);
  for (double& a : x) a = u(random);
  for (double& a : y) a = v(random);
  std::size_t careful = 0;
  for (auto _ : state) careful = curve.query(x, y, distance, t);
  state.counters["careful_share"] = static_cast<double>(careful) / static_cast<double>(count);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}

// A gentle rib, and a cusp and a loop as the degenerate cases.
void points_to_cubic(benchmark::State& state) {
  const std::array<Vector2d, 4> curves[] = {{{{0, 0}, {300, 120}, {700, 140}, {1000, 0}}},
                                            {{{0, 0}, {1000, 300}, {0, 300}, {1000, 0}}},
                                            {{{0, 0}, {2000, 300}, {-1000, 300}, {1000, 0}}}};
  const auto which = static_cast<std::size_t>(state.range(0));
  points_to(state, CurveDistance::to_cubic(curves[which]), which == 0 ? 1000000 : 20000);
}
BENCHMARK(points_to_cubic)
    ->Name("PointsToCubic")
    ->ArgName("gentle_cusp_loop")
    ->DenseRange(0, 2)
    ->Unit(benchmark::kMillisecond);

void points_to_quadratic(benchmark::State& state) {
  const std::array<Vector2d, 3> curve{{{0, 0}, {500, 250}, {1000, 0}}};
  points_to(state, CurveDistance::to_quadratics(std::span(&curve, 1)), 1000000);
}
BENCHMARK(points_to_quadratic)->Name("PointsToQuadratic")->Unit(benchmark::kMillisecond);

// A rib with an inflection, within 10^-n of the unit.
void points_to_elastica(benchmark::State& state) {
  const elastica::Elastica rib{0, 100, 0.3, -1e-3, 0, 3e-6, 1000};
  const elastica::QuadraticChain chain =
      elastica::quadratic_chain(rib, std::pow(10.0, -static_cast<double>(state.range(0))));
  state.counters["pieces"] = static_cast<double>(chain.pieces.size());
  state.counters["bound"] = chain.bound;
  points_to(state, CurveDistance::to_quadratics(chain.pieces), 200000);
}
BENCHMARK(points_to_elastica)
    ->Name("PointsToElastica")
    ->ArgName("digits")
    ->Arg(1)
    ->Arg(3)
    ->Arg(6)
    ->Unit(benchmark::kMillisecond);

void residuals(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<std::array<Vector2d, 4>> curves(100000);
  for (auto& c : curves) {
    for (Vector2d& p : c) p = {u(random), u(random)};
  }
  std::vector<double> e(curves.size());
  std::vector<gpu::ResidualStatus> status(curves.size());
  const gpu::LambdaResiduals lambda;
  for (auto _ : state) lambda.query(curves, e, status);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(curves.size()));
}
BENCHMARK(residuals)->Name("LambdaResiduals")->Unit(benchmark::kMillisecond);

}  // namespace
