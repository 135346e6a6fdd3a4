// Points to curves, residuals and pairs of curves in bulk, one thread.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

#include "elastica/bezier/curve_distance.hpp"
#include "elastica/fit/fit_bezier.hpp"
#include "elastica/quadratic/quadratic_chain.hpp"
#include "gpu/curve/curve_distance.hpp"
#include "gpu/curve/lambda_residuals.hpp"
#include "gpu/curve/pair_distance.hpp"

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

// Rib-like cubics with the elastica fitted to them, or pairs with nothing to do with each other.
struct Pairs {
  std::vector<std::array<Vector2d, 4>> beziers;
  std::vector<gpu::ElasticaState> elastica;
};

Pairs some_pairs(bool fitted, std::size_t count) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(-1, 1);
  Pairs pairs;
  pairs.beziers.resize(count);
  for (auto& b : pairs.beziers) {
    const double a = 300 + 60 * u(random), c = 150 * u(random), d = 700 + 60 * u(random);
    b = {Vector2d(0, 0), {a, c}, {d, 150 * u(random)}, {1000, 0}};
  }
  const auto fits = elastica::fit_bezier_elastica(pairs.beziers);
  for (std::size_t i = 0; i < count; ++i) {
    const elastica::Elastica& e = fits[fitted ? i : (i * 7 + 1) % count].elastica;
    const double turn = fitted ? 0 : u(random);
    const double c = std::cos(turn), s = std::sin(turn);
    pairs.elastica.push_back({e.x, e.y, e.theta + turn, e.kappa, c * e.lambda1 - s * e.lambda2,
                              s * e.lambda1 + c * e.lambda2, e.length});
  }
  return pairs;
}

// Hausdorff within 10^-n of the unit, a rib being 1000 long; 0 stands for 1.
void pair_distances(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const bool fitted = state.range(0) == 0;
  const double tolerance = std::pow(10.0, -static_cast<double>(state.range(1)));
  const std::size_t count = fitted ? 20000 : 500;
  const Pairs pairs = some_pairs(fitted, count);
  const gpu::PairDistances distances;
  std::vector<gpu::PairDistance> out(count);
  std::size_t careful = 0;
  for (auto _ : state) careful = distances.query(pairs.beziers, pairs.elastica, tolerance, out);
  state.counters["careful_share"] = static_cast<double>(careful) / static_cast<double>(count);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}
BENCHMARK(pair_distances)
    ->Name("PairDistances")
    ->ArgNames({"strangers", "digits"})
    ->ArgsProduct({{0, 1}, {0, 1, 2}})
    ->Unit(benchmark::kMillisecond);

// The same pairs by the one-pair routine, as a peer: its bounds are 1e-6 of the length apart.
void pairs_one_by_one(benchmark::State& state) {
  const Pairs pairs = some_pairs(state.range(0) == 0, 50);
  for (auto _ : state) {
    for (std::size_t i = 0; i < pairs.beziers.size(); ++i) {
      const gpu::ElasticaState& e = pairs.elastica[i];
      benchmark::DoNotOptimize(
          elastica::distance(pairs.beziers[i], {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length}));
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(pairs.beziers.size()));
}
BENCHMARK(pairs_one_by_one)
    ->Name("PairsOneByOne")
    ->ArgName("strangers")
    ->DenseRange(0, 1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
