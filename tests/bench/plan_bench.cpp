// Whole plans of the samples, reading included.
#include <benchmark/benchmark.h>

#include "pipeline/plan/plan.hpp"

namespace {

using namespace hotblade;

void PlanSample(benchmark::State& state, const char* name) {
  const std::string base = std::string(HOTBLADE_SOURCE_DIR) + "/samples/" + name;
  const pipeline::Settings settings = pipeline::resolve({{base + ".toml"}, {}, {}});
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        pipeline::plan(surface::read_obj(base + ".obj", {settings.design.units, 'z'}), settings, {}));
  }
}
BENCHMARK_CAPTURE(PlanSample, barrel_vault, "barrel_vault")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(PlanSample, s_wall, "s_wall")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(PlanSample, hypar, "hypar")->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(PlanSample, bump, "bump")->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
