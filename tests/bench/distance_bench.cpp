// Points to a mesh: ours beside Embree, CGAL and VTK, ordered queries near the surface and scattered ones.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "gpu/mesh/mesh_distance.hpp"
#include "tests/bench/wavy_shell.hpp"

namespace {

using namespace hotblade::bench;
using hotblade::gpu::MeshDistance;

// As many as there are triangles, as when a design is verified, within what a peer answers in a few seconds.
int query_count(std::int64_t triangles) {
  return static_cast<int>(std::clamp<std::int64_t>(triangles, 20000, 200000));
}

void ours(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(2)));
  const PeerMesh s = wavy_shell(state.range(0));
  const MeshDistance mesh(vectors(s.vertices), s.triangles);
  const auto points = vectors(shell_points(state.range(1), query_count(state.range(0))));
  for (auto _ : state) benchmark::DoNotOptimize(mesh.query(points));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}

template <std::unique_ptr<Peer> (*kMake)(const PeerMesh&)>
void peer(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(2)));
  const std::unique_ptr<Peer> mesh = kMake(wavy_shell(state.range(0)));
  const auto points = shell_points(state.range(1), query_count(state.range(0)));
  std::vector<double> distances;
  for (auto _ : state) mesh->query(points, distances);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}

void build(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(1)));
  const PeerMesh s = wavy_shell(state.range(0));
  const auto vertices = vectors(s.vertices);
  for (auto _ : state) benchmark::DoNotOptimize(MeshDistance(vertices, s.triangles));
}

template <std::unique_ptr<Peer> (*kMake)(const PeerMesh&)>
void build_peer(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(1)));
  const PeerMesh s = wavy_shell(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(kMake(s));
}

// Ours and the peers one after the other for every case, so that a ratio is of neighbours in time.
int register_all() {
  for (const std::int64_t triangles : {1000, 10000, 100000, 1000000, 10000000}) {
    for (const std::int64_t order : {kOrdered, kScattered, kFar}) {
      for (const std::int64_t threads : {1, 2}) {
        const auto add = [&](const char* name, void (*run)(benchmark::State&)) {
          benchmark::RegisterBenchmark(name, run)
              ->ArgNames({"triangles", "order", "threads"})
              ->Args({triangles, order, threads})
              ->MeasureProcessCPUTime()
              ->UseRealTime()
              ->Unit(benchmark::kMillisecond);
        };
        add("PointsToMesh/Ours", ours);
        add("PointsToMesh/Embree", peer<embree_from_last>);
        add("PointsToMesh/Cgal", peer<cgal_tree>);
        add("PointsToMesh/Vtk", peer<vtk_locator>);
      }
    }
  }
  for (const std::int64_t triangles : {100000, 1000000, 10000000}) {
    for (const std::int64_t threads : {1, 2}) {
      const auto add = [&](const char* name, void (*run)(benchmark::State&)) {
        benchmark::RegisterBenchmark(name, run)
            ->ArgNames({"triangles", "threads"})
            ->Args({triangles, threads})
            ->MeasureProcessCPUTime()
            ->UseRealTime()
            ->Unit(benchmark::kMillisecond);
      };
      add("BuildMesh/Ours", build);
      add("BuildMesh/Embree", build_peer<embree_from_last>);
    }
  }
  return 0;
}
[[maybe_unused]] const int kRegistered = register_all();

}  // namespace
