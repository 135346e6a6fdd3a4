// Points to a mesh: ours beside Embree, CGAL and VTK, ordered queries near the surface and scattered ones.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <random>

#include "gpu/mesh/mesh_distance.hpp"
#include "tests/bench/distance_peers.hpp"

namespace {

using hotblade::bench::Peer;
using hotblade::bench::PeerMesh;
using hotblade::gpu::MeshDistance;

double height(double x, double y) {
  return 60 * std::sin(x / 130) * std::cos(y / 170);
}

// A wavy square of about `count` triangles, 1000 mm wide.
PeerMesh shell(std::int64_t count) {
  PeerMesh s;
  const int n = static_cast<int>(std::sqrt(static_cast<double>(count) / 2));
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = 1000.0 * i / n, y = 1000.0 * j / n;
      s.vertices.push_back({x, y, height(x, y)});
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, c = a + n + 1;
      s.triangles.push_back({a, c, c + 1});
      s.triangles.push_back({a, c + 1, a + 1});
    }
  }
  return s;
}

std::vector<Eigen::Vector3d> vectors(const std::vector<std::array<double, 3>>& points) {
  std::vector<Eigen::Vector3d> v;
  for (const auto& p : points) v.emplace_back(p[0], p[1], p[2]);
  return v;
}

// Ordered: a grid half a millimetre off the surface, row by row. Otherwise scattered as near as that, or
// (far) through the shell's box.
enum Order { kScattered = 0, kOrdered = 1, kFar = 2 };

std::vector<std::array<double, 3>> queries(std::int64_t order, int count) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(0, 1000), z(-60, 60);
  const int side = static_cast<int>(std::sqrt(count));
  std::vector<std::array<double, 3>> points;
  for (int i = 0; i < side * side; ++i) {
    double x = 1000.0 * (i / side) / side, y = 1000.0 * (i % side) / side;
    if (order != kOrdered) {
      x = u(random);
      y = u(random);
    }
    points.push_back({x, y, order == kFar ? z(random) : height(x, y) + 0.5});
  }
  return points;
}

// As many as there are triangles, as when a design is verified, within what a peer answers in a few seconds.
int query_count(std::int64_t triangles) {
  return static_cast<int>(std::clamp<std::int64_t>(triangles, 20000, 200000));
}

void ours(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(2)));
  const PeerMesh s = shell(state.range(0));
  const MeshDistance mesh(vectors(s.vertices), s.triangles);
  const auto points = vectors(queries(state.range(1), query_count(state.range(0))));
  for (auto _ : state) benchmark::DoNotOptimize(mesh.query(points));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}

template <std::unique_ptr<Peer> (*kMake)(const PeerMesh&)>
void peer(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(2)));
  const std::unique_ptr<Peer> mesh = kMake(shell(state.range(0)));
  const auto points = queries(state.range(1), query_count(state.range(0)));
  std::vector<double> distances;
  for (auto _ : state) mesh->query(points, distances);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}

void build(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(1)));
  const PeerMesh s = shell(state.range(0));
  const auto vertices = vectors(s.vertices);
  for (auto _ : state) benchmark::DoNotOptimize(MeshDistance(vertices, s.triangles));
}

template <std::unique_ptr<Peer> (*kMake)(const PeerMesh&)>
void build_peer(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(1)));
  const PeerMesh s = shell(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(kMake(s));
}

// Ours and the peers one after the other for every case, so that a ratio is of neighbours in time.
int register_all() {
  using namespace hotblade::bench;
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
