// Points to a mesh: ours beside CGAL's AABB tree, ordered queries near the surface and scattered ones.
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

#include "gpu/mesh_distance.hpp"

namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_face_graph_triangle_primitive<Mesh>>>;

struct Shell {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
};

double height(double x, double y) {
  return 60 * std::sin(x / 130) * std::cos(y / 170);
}

// A wavy square of about `count` triangles, 1000 mm wide.
Shell shell(std::int64_t count) {
  Shell s;
  const int n = static_cast<int>(std::sqrt(static_cast<double>(count) / 2));
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = 1000.0 * i / n, y = 1000.0 * j / n;
      s.vertices.emplace_back(x, y, height(x, y));
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

constexpr int kQueries = 20000;

// Ordered: a grid half a millimetre off the surface, row by row. Otherwise scattered in the shell's box.
std::vector<Eigen::Vector3d> queries(bool ordered) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(0, 1000), z(-60, 60);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < kQueries; ++i) {
    const double x = ordered ? 1000.0 * (i / 200) / 100 : u(random),
                 y = ordered ? 5.0 * (i % 200) : u(random);
    points.emplace_back(x, y, ordered ? height(x, y) + 0.5 : z(random));
  }
  return points;
}

void PointsToMesh(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(2)));
  const Shell s = shell(state.range(0));
  const hotblade::gpu::MeshDistance mesh(s.vertices, s.triangles);
  const auto points = queries(state.range(1) != 0);
  for (auto _ : state) benchmark::DoNotOptimize(mesh.query(points));
  state.SetItemsProcessed(state.iterations() * kQueries);
}
BENCHMARK(PointsToMesh)
    ->ArgNames({"triangles", "ordered", "threads"})
    ->ArgsProduct({{10000, 100000, 1000000}, {1, 0}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void PointsToMeshByCgal(benchmark::State& state) {
  const Shell s = shell(state.range(0));
  Mesh mesh;
  for (const auto& p : s.vertices) mesh.add_vertex({p.x(), p.y(), p.z()});
  for (const auto& t : s.triangles) {
    mesh.add_face(Mesh::Vertex_index(static_cast<unsigned>(t[0])),
                  Mesh::Vertex_index(static_cast<unsigned>(t[1])),
                  Mesh::Vertex_index(static_cast<unsigned>(t[2])));
  }
  Tree tree(faces(mesh).begin(), faces(mesh).end(), mesh);
  tree.accelerate_distance_queries();
  const auto points = queries(state.range(1) != 0);
  for (auto _ : state) {
    for (const auto& p : points)
      benchmark::DoNotOptimize(tree.closest_point_and_primitive({p.x(), p.y(), p.z()}));
  }
  state.SetItemsProcessed(state.iterations() * kQueries);
}
BENCHMARK(PointsToMeshByCgal)
    ->ArgNames({"triangles", "ordered"})
    ->ArgsProduct({{10000, 100000, 1000000}, {1, 0}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
