// A million samples both ways between a design of 100,000 triangles and its cut: verify, its distances alone,
// and the same distances by CGAL.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include "gpu/mesh/mesh_distance.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/verify/swept_surface.hpp"
#include "pipeline/verify/verify.hpp"
#include "tests/bench/distance_peers.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace {

using namespace hotblade;
using Eigen::Vector3d;

// Every triangle into four, twice.
surface::TriangleSoup refined(surface::TriangleSoup mesh) {
  for (int n = 0; n < 2; ++n) {
    std::map<std::pair<int, int>, int> middles;
    surface::TriangleSoup fine;
    fine.vertices = mesh.vertices;
    const auto middle = [&](int a, int b) {
      const auto [at, fresh] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(fine.vertices.size()));
      if (fresh) {
        fine.vertices.push_back(
            0.5 * (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]));
      }
      return at->second;
    };
    for (const auto& t : mesh.triangles) {
      const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      for (const std::array<int, 3>& part :
           {std::array{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}}) {
        fine.triangles.push_back(part);
      }
    }
    mesh = std::move(fine);
  }
  return mesh;
}

// The vault's sample in 96,768 triangles, its plan, and what is measured.
struct Case {
  surface::DesignSurface design;
  pipeline::Program program;
  pipeline::SweptSurface cut;
  std::vector<Vector3d> on_design;
  static constexpr double kSample_mm = 0.7;  // about a million samples each way

  Case() {
    const std::string base = std::string(HOTBLADE_SOURCE_DIR) + "/samples/barrel_vault";
    const pipeline::Settings settings = pipeline::resolve({{base + ".toml"}, {}, {}});
    const surface::TriangleSoup mesh = refined(surface::read_obj(base + ".obj", {"mm", 'z'}).mesh.soup());
    const pipeline::testing::TemporaryDirectory directory;
    {
      std::ofstream out(directory / "vault.obj");
      out.precision(17);
      for (const Vector3d& v : mesh.vertices) out << "v " << v.transpose() << "\n";
      for (const auto& t : mesh.triangles)
        out << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    }
    design = surface::read_obj(directory / "vault.obj", {"mm", 'z'});
    program = pipeline::plan(design, settings, {}).program;
    cut = pipeline::swept_surface(program, kSample_mm);
    // As many points of the design, face by face.
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> u(0, 1);
    const std::size_t each = std::max<std::size_t>(1, cut.vertices.size() / design.mesh.triangles().size());
    for (const auto& t : design.mesh.triangles()) {
      const auto at = [&](std::size_t k) { return design.mesh.vertices()[static_cast<std::size_t>(t[k])]; };
      for (std::size_t i = 0; i < each; ++i) {
        const double s = std::sqrt(u(random)), v = u(random);
        on_design.push_back((1 - s) * at(0) + s * (1 - v) * at(1) + s * v * at(2));
      }
    }
  }
};
const Case& vault() {
  static const Case instance;
  return instance;
}

tbb::global_control threads(const benchmark::State& state) {
  return {tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(state.range(0))};
}

void verify_million(benchmark::State& state) {
  const auto limit = threads(state);
  const Case& c = vault();
  pipeline::VerifyOptions options;
  options.sample_mm = Case::kSample_mm;
  for (auto _ : state) {
    const pipeline::VerifyReport report = pipeline::verify(c.program, c.design, options);
    state.counters["cut_samples"] = static_cast<double>(report.cut_samples);
    state.counters["design_samples"] = static_cast<double>(report.design_samples);
  }
}

void distances_million(benchmark::State& state) {
  const auto limit = threads(state);
  const Case& c = vault();
  for (auto _ : state) {
    const gpu::MeshDistance to_design(c.design.mesh.vertices(), c.design.mesh.triangles());
    benchmark::DoNotOptimize(to_design.query(c.cut.vertices));
    const gpu::MeshDistance to_cut(c.cut.vertices, c.cut.triangles);
    benchmark::DoNotOptimize(to_cut.query(c.on_design));
  }
  state.counters["points"] = static_cast<double>(c.cut.vertices.size() + c.on_design.size());
}

using Plain = std::vector<std::array<double, 3>>;
Plain plain(const std::vector<Vector3d>& points) {
  Plain out;
  for (const Vector3d& p : points) out.push_back({p.x(), p.y(), p.z()});
  return out;
}

template <std::unique_ptr<bench::Peer> (*kMake)(const bench::PeerMesh&)>
void peer_million(benchmark::State& state) {
  const auto limit = threads(state);
  const Case& c = vault();
  const surface::TriangleSoup soup = c.design.mesh.soup();
  const bench::PeerMesh design{plain(soup.vertices), soup.triangles},
      cut{plain(c.cut.vertices), c.cut.triangles};
  const Plain on_design = plain(c.on_design);
  std::vector<double> distances;
  for (auto _ : state) {
    kMake(design)->query(cut.vertices, distances);
    kMake(cut)->query(on_design, distances);
  }
}

int register_all() {
  for (const std::int64_t n : {1, 2}) {
    const auto add = [&](const char* name, void (*run)(benchmark::State&)) {
      benchmark::RegisterBenchmark(name, run)
          ->ArgName("threads")
          ->Arg(n)
          ->MeasureProcessCPUTime()
          ->UseRealTime()
          ->Unit(benchmark::kMillisecond);
    };
    add("VerifyMillion/Verify", verify_million);
    add("VerifyMillion/Distances", distances_million);
    add("VerifyMillion/Cgal", peer_million<bench::cgal_tree>);
    add("VerifyMillion/Embree", peer_million<bench::embree_from_last>);
  }
  return 0;
}
[[maybe_unused]] const int kRegistered = register_all();

}  // namespace
