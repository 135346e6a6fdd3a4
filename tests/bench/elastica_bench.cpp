// Curves: evaluation beside Boost's Jacobi functions, residual, projection, fit.
#include <benchmark/benchmark.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "elastica/bezier/lambda_residual.hpp"
#include "elastica/blade/continuation.hpp"
#include "elastica/blade/equilibria.hpp"
#include "elastica/blade/stability.hpp"
#include "elastica/fit/fit.hpp"
#include "elastica/fit/fit_bezier.hpp"
#include "elastica/projection/project.hpp"
#include "elastica/projection/spline.hpp"

namespace {

using namespace hotblade::elastica;

// One period of the elastica of modulus k, whose curvature at the vertex is 2 k.
Elastica one_period(double k) {
  return {0, 0, 0, 2 * k, 1, 0, 4 * boost::math::ellint_1(k)};
}

void ElasticaPoints(benchmark::State& state) {
  const Elastica e = one_period(0.7);
  const int n = static_cast<int>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(sample(e, n));
  state.SetItemsProcessed(state.iterations() * n);
}
BENCHMARK(ElasticaPoints)->Arg(16)->Arg(1000);

void ElasticaPointsByBoost(benchmark::State& state) {
  const double k = 0.7, length = 4 * boost::math::ellint_1(k);
  const int n = static_cast<int>(state.range(0));
  for (auto _ : state) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double s = length * i / (n - 1);
      double cn = 0, dn = 0;
      const double sn = boost::math::jacobi_elliptic(k, s, &cn, &dn);
      sum += 2 * boost::math::ellint_2(k, std::atan2(sn, cn)) - s + 2 * k * (1 - cn);
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * n);
}
BENCHMARK(ElasticaPointsByBoost)->Arg(1000);

std::vector<Bezier> random_beziers(std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Bezier> curves(count);
  for (Bezier& b : curves) {
    for (auto& p : b) p = {u(random), u(random)};
  }
  return curves;
}

void Residual(benchmark::State& state) {
  const auto curves = random_beziers(1000);
  for (auto _ : state) {
    for (const Bezier& b : curves) benchmark::DoNotOptimize(lambda_residual(b));
  }
  state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK(Residual);

void Projection(benchmark::State& state) {
  const auto curves = random_beziers(200);
  for (auto _ : state) {
    for (const Bezier& b : curves) benchmark::DoNotOptimize(project_feedback(b, 0));
  }
  state.SetItemsProcessed(state.iterations() * 200);
}
BENCHMARK(Projection);

void OptimalProjection(benchmark::State& state) {
  const auto curves = random_beziers(1000);
  std::vector<hotblade::elastica::Projection> out(curves.size());
  for (auto _ : state) {
    project_optimal(curves, WantedBranch::kBest, out);
    benchmark::DoNotOptimize(out.data());
  }
  state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK(OptimalProjection);

void OptimalProjectionBySearch(benchmark::State& state) {
  const auto curves = random_beziers(10);
  for (auto _ : state) {
    for (const Bezier& b : curves)
      benchmark::DoNotOptimize(project_optimal_search(b, WantedBranch::kBest, {}));
  }
  state.SetItemsProcessed(state.iterations() * 10);
}
BENCHMARK(OptimalProjectionBySearch);

void SmallestMove(benchmark::State& state) {
  const auto curves = random_beziers(10);
  for (auto _ : state) {
    for (const Bezier& b : curves)
      benchmark::DoNotOptimize(project_smallest_move(b, WantedBranch::kBest, 0.1));
  }
  state.SetItemsProcessed(state.iterations() * 10);
}
BENCHMARK(SmallestMove);

void SplitIntoElastica(benchmark::State& state) {
  const Bezier hook{Eigen::Vector2d(0, 0), {700, 500}, {900, -600}, {1000, 300}};
  for (auto _ : state) benchmark::DoNotOptimize(split_to_elastica(hook, 1, 10));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(SplitIntoElastica);

void Fit(benchmark::State& state) {
  std::vector<Eigen::Vector2d> q;
  for (const CurvePoint& p : sample({0, 0, 0.2, 1e-3, 4e-6, -3e-6, 800}, 65)) q.push_back(p.position());
  const Bezier bezier = fit_bezier(q).bezier;
  const std::vector<Elastica> starts{first_guess(bezier, lambda_residual(bezier))};
  for (auto _ : state) benchmark::DoNotOptimize(fit_elastica(q, starts, {}));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(Fit);

// Cubics of the paper's angle and edge constraints, e <= 0.4, all from the one start that they need.
std::vector<Bezier> constrained_beziers(std::size_t n) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Bezier> curves;
  while (curves.size() < n) {
    const double a1 = u(random) * 2 * std::numbers::pi / 3, l1 = 0.27 + 0.5 * (u(random) + 1) * 0.4;
    const double a2 = std::numbers::pi * (1 + 0.4 * u(random)) - a1, l2 = 0.27 + 0.5 * (u(random) + 1) * 0.4;
    const Bezier b{Eigen::Vector2d(0, 0),
                   {l1 * std::cos(a1), l1 * std::sin(a1)},
                   {1 + l2 * std::cos(a2), l2 * std::sin(a2)},
                   {1, 0}};
    if (lambda_residual(b).value <= 0.4) curves.push_back(b);
  }
  return curves;
}

void FitBeziers(benchmark::State& state) {
  const auto curves = constrained_beziers(4096);
  for (auto _ : state) benchmark::DoNotOptimize(fit_bezier_elastica(curves));
  state.SetItemsProcessed(state.iterations() * 4096);
}
BENCHMARK(FitBeziers);

void FitOneBezier(benchmark::State& state) {
  const auto curves = constrained_beziers(256);
  for (auto _ : state) {
    for (const Bezier& b : curves) benchmark::DoNotOptimize(fit_bezier_elastica(b));
  }
  state.SetItemsProcessed(state.iterations() * 256);
}
BENCHMARK(FitOneBezier);

// An arch whose clamps move by up to a millimetre and a few mrad from pose to pose, stability included.
void EquilibriumFromNeighbour(benchmark::State& state) {
  Elastica e = follow({0, 0, 0.6, -1.2 / 800, 0, 0, 800}, {{0, 0, 0.6}, {740, 0, -0.6}}).shape.elastica;
  const ClampPair held = clamps_of(e);
  int pose = 0, lost = 0;
  for (auto _ : state) {
    ClampPair clamps = held;
    clamps.b.x += 0.5 * std::sin(0.01 * pose);
    clamps.b.y += 5 * std::sin(0.003 * pose);
    clamps.a.theta += 0.02 * std::sin(0.005 * pose++);
    const auto shape = solve_clamped(e, clamps);
    if (shape && shape->stable()) {
      e = shape->elastica;
    } else {
      ++lost;
    }
  }
  if (lost > 0) state.SkipWithError("an equilibrium was lost");
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(EquilibriumFromNeighbour);

// Every shape of the symmetric arch with up to two inflections.
void AllEquilibria(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(find_equilibria({{0, 0, 0.6}, {0.8, 0, -0.6}}, 1));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(AllEquilibria);

void Margin(benchmark::State& state) {
  const Elastica e{0, 0, 0.2, 1e-3, 4e-6, -3e-6, 800};
  for (auto _ : state) benchmark::DoNotOptimize(stability_margin(e));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(Margin);

}  // namespace
