// The single-precision search alone: its bound, and that it never leaves out the nearest triangle.
#include "gpu/mesh/mesh_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gpu/mesh/mesh_frame.hpp"
#include "gpu/mesh/mesh_tree.hpp"
#include "tests/gpu/soup.hpp"

namespace hotblade::gpu {
namespace {

using Eigen::Vector3d;

#define REAL float
#include "gpu/kernels/triangle.h"
#undef REAL

float lane_distance(const TrianglePacket& p, std::size_t i, const std::array<float, 3>& q) {
  return std::sqrt(triangle_distance_sq(q[0] - p.origin[0][i], q[1] - p.origin[1][i], q[2] - p.origin[2][i],
                                        p.u[0][i], p.u[1][i], p.u[2][i], p.v[0][i], p.v[1][i], p.v[2][i],
                                        p.base[i], p.foot[i], p.rise[i], p.inv_left[i], p.inv_right[i]));
}

// Triangles of every shape: random, needles, caps, segments and points.
test::Soup shapes(std::mt19937_64& rng) {
  test::Soup soup;
  for (int i = 0; i < 400; ++i) {
    const double size = std::pow(10.0, -0.01 * i), width = i % 5 == 0 ? 0 : std::pow(10.0, -0.04 * (i % 300));
    const Vector3d a = test::random_point(rng, 1), b = a + test::random_point(rng, size);
    const double where = i % 3 == 0 ? 1.0 : 0.3;
    soup.vertices.insert(soup.vertices.end(), {a, i % 7 == 0 ? a : b,
                                               a + where * (b - a) + test::random_point(rng, width * size)});
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return soup;
}

TEST(MeshSearch, SinglePrecisionStaysWithinItsBoundForEveryShape) {
  std::mt19937_64 rng(1);
  const test::Soup soup = shapes(rng);
  const MeshFrame frame = make_mesh_frame(soup.vertices, soup.triangles);
  const MeshTree tree = build_mesh_tree(frame.vertices, frame.triangles);
  double largest_share = 0;
  for (int n = 0; n < 300; ++n) {
    const Vector3d q = test::random_point(rng, std::pow(10.0, 0.02 * n - 3));
    const std::array<float, 3> q32{static_cast<float>(q.x()), static_cast<float>(q.y()),
                                   static_cast<float>(q.z())};
    for (const TrianglePacket& packet : tree.packets()) {
      for (std::size_t i = 0; i < HOTBLADE_TREE_WIDTH; ++i) {
        if (packet.triangle[i] < 0) continue;
        const double distance = std::sqrt(frame.distance(packet.triangle[i], q).distance_sq);
        const double bound =
            static_cast<double>(HOTBLADE_POSITION_ERROR) * (1 + q.cwiseAbs().maxCoeff()) +
            static_cast<double>(HOTBLADE_SHAPE_ERROR) * (distance + static_cast<double>(packet.base[i]));
        const double error = std::abs(static_cast<double>(lane_distance(packet, i, q32)) - distance);
        ASSERT_LE(error, bound) << "triangle " << packet.triangle[i] << " point " << q.transpose();
        largest_share = std::max(largest_share, error / bound);
      }
    }
  }
  // A bound that nothing comes near would hide a wrong formula behind its width.
  EXPECT_GT(largest_share, 0.1);
}

struct Case {
  const char* name;
  MeshSearch (*search)();
};

class MeshSearchOnEachInstructionSet : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
#if defined(__x86_64__)
    if (std::string_view(GetParam().name) == "Avx2" &&
        !(__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))) {
      GTEST_SKIP() << "this processor has no AVX2";
    }
#endif
  }
};

struct Local {
  MeshFrame frame;
  MeshTree tree;
  explicit Local(const test::Soup& soup)
      : frame(make_mesh_frame(soup.vertices, soup.triangles)),
        tree(build_mesh_tree(frame.vertices, frame.triangles)) {}
  [[nodiscard]] int nearest(const Vector3d& q) const {
    int best = 0;
    for (int i = 1; i < static_cast<int>(frame.triangles.size()); ++i) {
      if (frame.distance(i, q).distance_sq < frame.distance(best, q).distance_sq) best = i;
    }
    return best;
  }
  [[nodiscard]] SearchInput input(const Vector3d& q, const Entry& entry, int start) const {
    const auto size = static_cast<float>(q.cwiseAbs().maxCoeff());
    return {tree.nodes().data(),
            tree.packets().data(),
            &entry,
            {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z())},
            HOTBLADE_POSITION_ERROR * (1 + size),
            start};
  }
};

bool holds(std::span<const Candidate> candidates, int triangle) {
  return std::any_of(candidates.begin(), candidates.end(),
                     [triangle](const Candidate& c) { return c.triangle == triangle; });
}

TEST_P(MeshSearchOnEachInstructionSet, CandidatesHoldTheNearestTriangleFromEveryStart) {
  std::mt19937_64 rng(2);
  const Local mesh(test::random_soup(rng, 700, 1, 0.1));
  const MeshSearch search = GetParam().search();
  std::array<Candidate, 64> room;
  const Entry none{{}, -1};
  for (const Vector3d& q : test::random_points(rng, 300, 1.5)) {
    const int expected = mesh.nearest(q);
    for (const int start : {-1, 0, static_cast<int>(mesh.tree.packets().size()) - 1}) {
      const SearchOutput found = search.candidates(mesh.input(q, none, start), room.data(), 64);
      ASSERT_LE(found.count, 64);
      EXPECT_TRUE(holds(std::span(room).first(static_cast<std::size_t>(found.count)), expected));
      EXPECT_GE(static_cast<double>(found.at_most), std::sqrt(mesh.frame.distance(expected, q).distance_sq));
    }
  }
}

TEST_P(MeshSearchOnEachInstructionSet, AnEntryHoldsAllThatIsWithinItsRadius) {
  std::mt19937_64 rng(3);
  const Local mesh(test::random_soup(rng, 3000, 1, 0.03));
  const MeshSearch search = GetParam().search();
  std::array<Candidate, 64> room;
  int used = 0;
  for (int n = 0; n < 60; ++n) {
    const Vector3d centre = test::random_point(rng, 1);
    const std::vector<Vector3d> group = test::random_points(rng, 8, 0.05, centre);
    Eigen::Vector3f low = group[0].cast<float>(), high = low;
    for (const Vector3d& q : group) {
      low = low.cwiseMin(q.cast<float>());
      high = high.cwiseMax(q.cast<float>());
    }
    Entry entry;
    search.entry(mesh.tree.nodes().data(), low.data(), high.data(), 0.2f, &entry);
    int packet = -1;
    for (const Vector3d& q : group) {
      const SearchOutput found = search.candidates(mesh.input(q, entry, packet), room.data(), 64);
      packet = found.packet;
      used += found.start <= entry.radius;
      EXPECT_TRUE(holds(std::span(room).first(static_cast<std::size_t>(found.count)), mesh.nearest(q)));
    }
  }
  EXPECT_GT(used, 100);
}

TEST_P(MeshSearchOnEachInstructionSet, SaysWhenCandidatesDoNotFit) {
  test::Soup soup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
  for (int i = 0; i < 100; ++i) soup.triangles.push_back({0, 1, 2});
  const Local mesh(soup);
  std::array<Candidate, 128> room;
  const Entry none{{}, -1};
  const SearchInput input = mesh.input({0.2, 0.2, 0.7}, none, -1);
  EXPECT_GT(GetParam().search().candidates(input, room.data(), 64).count, 64);
  EXPECT_EQ(GetParam().search().candidates(input, room.data(), 128).count, 100);
}

INSTANTIATE_TEST_SUITE_P(, MeshSearchOnEachInstructionSet,
                         testing::Values(Case{"Baseline", mesh_search_baseline},
                                         Case{"Avx2", mesh_search_avx2}),
                         [](const auto& instantiation) { return instantiation.param.name; });

// Every triangle in one packet, every box holding what is below it, and no deeper than the stack allows.
void expect_sound(const MeshTree& tree, std::size_t triangles) {
  std::vector<int> seen(triangles, 0);
  const auto visit = [&](auto&& self, int node, int depth) -> void {
    ASSERT_LT(depth * (HOTBLADE_TREE_WIDTH - 1), HOTBLADE_TREE_STACK);
    for (std::size_t i = 0; i < HOTBLADE_TREE_WIDTH; ++i) {
      const TreeNode& n = tree.nodes()[static_cast<std::size_t>(node)];
      if (n.low[0][i] > n.high[0][i]) continue;
      if (n.child[i] >= 0) {
        self(self, n.child[i], depth + 1);
        continue;
      }
      const int packet = ~n.child[i];
      for (const int t : tree.packets()[static_cast<std::size_t>(packet)].triangle) {
        if (t >= 0) ++seen[static_cast<std::size_t>(t)];
      }
    }
  };
  visit(visit, 0, 1);
  EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
}

TEST(MeshTree, HoldsEveryTriangleOnceHoweverTheyLie) {
  std::mt19937_64 rng(4);
  test::Soup geometric, same;
  for (int i = 0; i < 3000; ++i) {
    const double x = std::pow(0.5, i % 50);
    geometric.vertices.emplace_back(x, 0, 0);
    same.vertices.emplace_back(1, 2, 3);
    geometric.triangles.push_back({i, i, i});
    same.triangles.push_back({i, i, i});
  }
  for (const test::Soup& soup : {test::random_soup(rng, 20000, 1, 0.01), geometric, same}) {
    const MeshFrame frame = make_mesh_frame(soup.vertices, soup.triangles);
    expect_sound(build_mesh_tree(frame.vertices, frame.triangles), soup.triangles.size());
  }
}

}  // namespace
}  // namespace hotblade::gpu
