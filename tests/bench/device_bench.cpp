// The work of an OpenCL device beside the same machine's processor, all cores of which take part in both:
// points to meshes, with the device's search and its copies alone, points to curves, residuals, and pairs of
// curves. Skipped, with the reason, where there is no device; HOTBLADE_OPENCL_DEVICE names one.
#include <benchmark/benchmark.h>

#include <memory>
#include <optional>
#include <random>

#include "elastica/fit/fit_bezier.hpp"
#include "elastica/quadratic/quadratic_chain.hpp"
#include "gpu/backend/opencl_device.hpp"
#include "gpu/curve/curve_distance.hpp"
#include "gpu/curve/lambda_residuals.hpp"
#include "gpu/curve/pair_distance.hpp"
#include "gpu/mesh/mesh_distance.hpp"
#include "gpu/mesh/mesh_distance_opencl.hpp"
#include "gpu/mesh/mesh_frame.hpp"
#include "tests/bench/wavy_shell.hpp"

namespace {

using namespace hotblade;
using namespace hotblade::bench;
using Eigen::Vector2d;
using Eigen::Vector3d;
using gpu::Backend;

bool has_device(benchmark::State& state) {
  try {
    state.SetLabel(gpu::find_opencl_device().name);
    return true;
  } catch (const gpu::DeviceError& error) {
    state.SkipWithError(error.what());
    return false;
  }
}

void count_items(benchmark::State& state, std::size_t items) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
}

// What the cases share is made once, as a hundred million points take long to draw.
struct Points {
  std::int64_t order = -1, count = -1;
  std::vector<std::array<double, 3>> plain;
  std::vector<Vector3d> points;
};
const Points& points_of(std::int64_t order, std::int64_t count) {
  static Points last;
  if (last.order == order && last.count == count) return last;
  last = {};
  last.order = order;
  last.count = count;
  last.plain = shell_points(order, count);
  last.points = vectors(last.plain);
  return last;
}

const PeerMesh& mesh_of(std::int64_t triangles) {
  static std::int64_t count = -1;
  static PeerMesh last;
  if (count != triangles) last = wavy_shell(triangles);
  count = triangles;
  return last;
}

void mesh_whole(benchmark::State& state, Backend backend) {
  if (backend == Backend::kOpenCl && !has_device(state)) return;
  const PeerMesh& s = mesh_of(state.range(0));
  const gpu::MeshDistance mesh(vectors(s.vertices), s.triangles, backend);
  const auto& points = points_of(state.range(1), state.range(2)).points;
  std::vector<gpu::Nearest> answers(points.size());
  mesh.query(points, answers);  // starts the device
  for ([[maybe_unused]] auto _ : state) mesh.query(points, answers);
  if (mesh.used().backend != backend) state.SkipWithError(mesh.used().reason.c_str());
  count_items(state, points.size());
}
void mesh_device(benchmark::State& state) {
  mesh_whole(state, Backend::kOpenCl);
}
void mesh_host(benchmark::State& state) {
  mesh_whole(state, Backend::kCpu);
}

void mesh_embree(benchmark::State& state) {
  const std::unique_ptr<Peer> mesh = embree_from_last(mesh_of(state.range(0)));
  const auto& points = points_of(state.range(1), state.range(2)).plain;
  std::vector<double> distances;
  for ([[maybe_unused]] auto _ : state) mesh->query(points, distances);
  count_items(state, points.size());
}

// The device's part: copies there and back, and the kernel, without what the host does with the answers.
void mesh_search(benchmark::State& state) {
  if (!has_device(state)) return;
  const PeerMesh& s = mesh_of(state.range(0));
  const gpu::MeshFrame frame = gpu::make_mesh_frame(vectors(s.vertices), s.triangles);
  const gpu::MeshSearchOnDevice search(frame, gpu::build_mesh_tree(frame.vertices, frame.triangles));
  const auto& points = points_of(state.range(1), state.range(2)).points;
  const auto ask = [&] { search.nearest(points, [](std::size_t, std::span<const gpu::Nearest>) {}); };
  ask();  // portions grow to their size
  for ([[maybe_unused]] auto _ : state) ask();
  count_items(state, points.size());
}

void copies(benchmark::State& state) {
  if (!has_device(state)) return;
  const auto device = gpu::shared_opencl_device();
  const auto bytes = static_cast<std::size_t>(state.range(0)) << 20;
  std::vector<char> data(bytes, 1);
  const gpu::DeviceBuffer buffer = device->upload(data.data(), bytes);
  for ([[maybe_unused]] auto _ : state) {
    if (state.range(1) == 0) {
      device->write(buffer, data.data(), bytes);
    } else {
      device->read(buffer, data.data(), bytes);
    }
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

// Points over the box of the curves below, 1000 wide.
void to_curve(benchmark::State& state, const gpu::CurveDistance& curve, Backend backend) {
  const auto count = static_cast<std::size_t>(state.range(1));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(0, 1000), v(0, 300);
  std::vector<double> x(count), y(count), distance(count), t(count);
  for (double& a : x) a = u(random);
  for (double& a : y) a = v(random);
  (void)curve.query(x, y, distance, t);
  for ([[maybe_unused]] auto _ : state) curve.query(x, y, distance, t);
  if (curve.used().backend != backend) state.SkipWithError(curve.used().reason.c_str());
  count_items(state, count);
}

// A gentle cubic, and an elastica as quadratics within 1e-3.
template <Backend kBackend>
void to_curves(benchmark::State& state) {
  if (kBackend == Backend::kOpenCl && !has_device(state)) return;
  if (state.range(0) == 0) {
    const std::array<Vector2d, 4> gentle{{{0, 0}, {300, 120}, {700, 140}, {1000, 0}}};
    to_curve(state, gpu::CurveDistance::to_cubic(gentle, kBackend), kBackend);
    return;
  }
  const elastica::Elastica rib{0, 100, 0.3, -1e-3, 0, 3e-6, 1000};
  to_curve(state, gpu::CurveDistance::to_quadratics(elastica::quadratic_chain(rib, 1e-3).pieces, kBackend),
           kBackend);
}

template <Backend kBackend>
void residuals(benchmark::State& state) {
  if (kBackend == Backend::kOpenCl && !has_device(state)) return;
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<std::array<Vector2d, 4>> curves(static_cast<std::size_t>(state.range(0)));
  for (auto& c : curves) {
    for (Vector2d& p : c) p = {u(random), u(random)};
  }
  std::vector<double> e(curves.size());
  std::vector<gpu::ResidualStatus> status(curves.size());
  const gpu::LambdaResiduals lambda(kBackend);
  lambda.query(curves, e, status);
  for ([[maybe_unused]] auto _ : state) lambda.query(curves, e, status);
  if (lambda.used().backend != kBackend) state.SkipWithError(lambda.used().reason.c_str());
  count_items(state, curves.size());
}

// Rib-like cubics 1000 long with the elastica fitted to them, as many different ones as kRibs.
template <Backend kBackend>
void pairs(benchmark::State& state) {
  if (kBackend == Backend::kOpenCl && !has_device(state)) return;
  constexpr std::size_t kRibs = 20000;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<std::array<Vector2d, 4>> beziers(kRibs);
  for (auto& b : beziers) {
    const double a = 300 + 60 * u(random), c = 150 * u(random), d = 700 + 60 * u(random);
    b = {Vector2d(0, 0), {a, c}, {d, 150 * u(random)}, {1000, 0}};
  }
  const auto fits = elastica::fit_bezier_elastica(beziers);
  const auto count = static_cast<std::size_t>(state.range(0));
  std::vector<std::array<Vector2d, 4>> asked(count);
  std::vector<gpu::ElasticaState> ribs(count);
  for (std::size_t i = 0; i < count; ++i) {
    const elastica::Elastica& e = fits[i % kRibs].elastica;
    asked[i] = beziers[i % kRibs];
    ribs[i] = {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length};
  }
  const gpu::PairDistances distances(kBackend);
  std::vector<gpu::PairDistance> out(count);
  (void)distances.query(asked, ribs, 0.1, out);
  for ([[maybe_unused]] auto _ : state) distances.query(asked, ribs, 0.1, out);
  if (distances.used().backend != kBackend) state.SkipWithError(distances.used().reason.c_str());
  count_items(state, count);
}

// Neighbours in time for every case, so that a ratio is of one state of the machine.
int register_all() {
  const auto add = [](const char* name, void (*run)(benchmark::State&), const std::vector<std::int64_t>& args,
                      const std::vector<std::string>& names) {
    benchmark::RegisterBenchmark(name, run)
        ->ArgNames(names)
        ->Args(args)
        ->MeasureProcessCPUTime()
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
  };
  constexpr std::int64_t kMillion = 1000000;
  for (const std::int64_t triangles : {kMillion / 10, kMillion}) {
    for (const std::int64_t count : {kMillion, 10 * kMillion, 100 * kMillion}) {
      for (const std::int64_t order : {kOrdered, kScattered}) {
        const auto each = [&](const char* name, void (*run)(benchmark::State&)) {
          add(name, run, {triangles, order, count}, {"triangles", "order", "points"});
        };
        each("Device/PointsToMesh/Device", mesh_device);
        each("Device/PointsToMesh/Host", mesh_host);
        each("Device/PointsToMesh/Embree", mesh_embree);
        if (count < 100 * kMillion) each("Device/PointsToMesh/Search", mesh_search);
      }
    }
  }
  add("Device/Copies", copies, {256, 0}, {"MiB", "back"});
  add("Device/Copies", copies, {256, 1}, {"MiB", "back"});
  for (const std::int64_t count : {kMillion, 10 * kMillion, 100 * kMillion}) {
    for (const std::int64_t rib : {0, 1}) {
      add("Device/PointsToCurve/Device", to_curves<Backend::kOpenCl>, {rib, count}, {"rib", "points"});
      add("Device/PointsToCurve/Host", to_curves<Backend::kCpu>, {rib, count}, {"rib", "points"});
    }
  }
  for (const std::int64_t count : {kMillion, 10 * kMillion}) {
    add("Device/LambdaResiduals/Device", residuals<Backend::kOpenCl>, {count}, {"curves"});
    add("Device/LambdaResiduals/Host", residuals<Backend::kCpu>, {count}, {"curves"});
  }
  for (const std::int64_t count : {kMillion / 10, kMillion}) {
    add("Device/Pairs/Device", pairs<Backend::kOpenCl>, {count}, {"pairs"});
    add("Device/Pairs/Host", pairs<Backend::kCpu>, {count}, {"pairs"});
  }
  return 0;
}
[[maybe_unused]] const int kRegistered = register_all();

}  // namespace
