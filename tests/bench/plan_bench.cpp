// Whole plans of the samples, reading included, and of the wave wall in 100,000 triangles stage by stage.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <fstream>

#include "pipeline/plan/plan.hpp"
#include "samples/sample_surfaces.hpp"
#include "tests/pipeline/temporary_directory.hpp"

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

// The wave wall in 100,000 triangles, its ribs level as its job says, compared at 1.8 million samples. The
// second argument is the tolerance in hundredths of a mm, the third the distance of the ribs in mm: 0 leaves
// it to the fit, 5 takes over 200 ribs, the case of the target. Counters are ms of each stage by the clock,
// and of all threads' processor time (..._cpu).
void PlanWaveWall(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(0)));
  const pipeline::testing::TemporaryDirectory directory;
  for (samples::SampleSurface wall : samples::sample_surfaces()) {
    if (wall.name != "wave_wall") continue;
    const double by = std::sqrt(100'000.0 / static_cast<double>(samples::triangle_count(wall)));
    wall.u_cells = static_cast<int>(std::lround(by * wall.u_cells));
    wall.v_cells = static_cast<int>(std::lround(by * wall.v_cells));
    std::ofstream(directory / "wall.obj") << samples::obj_text(wall);
  }
  pipeline::Settings settings =
      pipeline::resolve({{std::string(HOTBLADE_SOURCE_DIR) + "/samples/wave_wall.toml"}, {}, {}});
  settings.design.tolerance_mm = 0.01 * static_cast<double>(state.range(1));
  settings.slice.spacing_mm = static_cast<double>(state.range(2));
  for (auto _ : state) {
    const surface::DesignSurface design =
        surface::read_obj(directory / "wall.obj", {settings.design.units, 'z'});
    const pipeline::PlanResult result = pipeline::plan(design, settings, {});
    for (const pipeline::StageTime& t : result.times) {
      state.counters[t.stage] = 1e3 * t.seconds;
      state.counters[t.stage + "_cpu"] = 1e3 * t.processor_s;
    }
    double ribs = 0, poses = 0;
    for (const pipeline::StripFacts& f : result.strips) ribs += static_cast<double>(f.ribs);
    for (const pipeline::Strip& strip : result.program.strips)
      poses += static_cast<double>(strip.poses.size());
    state.counters["ribs"] = ribs;
    state.counters["poses"] = poses;
    state.counters["samples"] = static_cast<double>(result.program.verification.samples);
  }
}
BENCHMARK(PlanWaveWall)
    ->ArgNames({"threads", "tolerance", "spacing"})
    ->ArgsProduct({{1, 2}, {100, 30}, {0}})
    ->ArgsProduct({{1, 2}, {100}, {5}})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
