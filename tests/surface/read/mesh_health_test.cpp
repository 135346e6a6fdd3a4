// Connectivity: borders, orientation, and surfaces that cannot be sliced.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "surface/read/design_surface.hpp"
#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

DesignSurface read_mesh(const TriangleSoup& mesh) {
  return read_text(to_obj(mesh));
}

TEST(MeshHealth, MeasuresAPlate) {
  const Health h =
      read_mesh(grid(10, 5, [](double s, double t) { return Eigen::Vector3d(200 * s, 100 * t, 3); })).health;
  EXPECT_EQ(h.vertices, 66U);
  EXPECT_EQ(h.triangles, 100U);
  EXPECT_EQ(h.components, 1U);
  EXPECT_EQ(h.border_loops, 1U);
  EXPECT_NEAR(h.border_length_mm, 600, 1e-9);
  EXPECT_NEAR(h.area_mm2, 20000, 1e-8);
  EXPECT_FALSE(h.closed);
  EXPECT_TRUE(h.orientable);
  EXPECT_EQ(h.bbox_mm[0], Eigen::Vector3d(0, 0, 3));
  EXPECT_EQ(h.bbox_mm[1], Eigen::Vector3d(200, 100, 3));
  EXPECT_THAT(h.blockers, IsEmpty());
}

TEST(MeshHealth, CountsBordersOfATubeAndAWindow) {
  const Health t = read_mesh(tube(100, 200, 24, 6)).health;
  EXPECT_EQ(t.border_loops, 2U);
  EXPECT_NEAR(t.border_length_mm, 2 * 24 * 200 * std::sin(std::numbers::pi / 24), 1e-9);
  const auto flat = [](double s, double v) { return Eigen::Vector3d(100 * s, 100 * v, 0); };
  const Health w =
      read_mesh(grid(10, 10, flat, [](int i, int j) { return i < 4 || i > 5 || j < 4 || j > 5; })).health;
  EXPECT_EQ(w.border_loops, 2U);
  EXPECT_NEAR(w.border_length_mm, 480, 1e-9);
  EXPECT_EQ(w.unused_vertices, 1U);
}

TEST(MeshHealth, SeesThatATetrahedronIsClosed) {
  const Health h =
      read_text("v 0 0 0\nv 90 0 0\nv 0 90 0\nv 0 0 90\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n").health;
  EXPECT_TRUE(h.closed);
  EXPECT_EQ(h.border_loops, 0U);
  EXPECT_THAT(h.repairs, IsEmpty());
}

TEST(MeshHealth, TurnsTheFewerFacesToAgreeInEachComponent) {
  TriangleSoup mesh = dome(500, 100, 6);
  const TriangleSoup right = mesh;
  for (std::size_t f = 0; f < mesh.triangles.size(); f += 3)
    std::swap(mesh.triangles[f][0], mesh.triangles[f][1]);
  const DesignSurface d = read_mesh(mesh);
  EXPECT_THAT(d.health.repairs, ElementsAre(HasSubstr("turned 24 faces over")));
  EXPECT_THAT(d.health.blockers, IsEmpty());
  for (const auto& t : d.mesh.triangles()) {
    const auto v = d.mesh.vertices();
    const Eigen::Vector3d a = v[static_cast<std::size_t>(t[0])];
    EXPECT_GT((v[static_cast<std::size_t>(t[1])] - a).cross(v[static_cast<std::size_t>(t[2])] - a).z(), 0);
  }
}

TEST(MeshHealth, LeavesAgreeingFacesAsTheyAre) {
  const TriangleSoup mesh = dome(500, 100, 6);
  const DesignSurface d = read_mesh(mesh);
  EXPECT_EQ(d.mesh.soup().triangles, mesh.triangles);
  EXPECT_EQ(d.mesh.soup().vertices, mesh.vertices);
  EXPECT_THAT(d.health.repairs, IsEmpty());
}

TEST(MeshHealth, BlocksAMoebiusStripWithThePlace) {
  std::string text;
  constexpr int kCells = 20;
  for (int i = 0; i < kCells; ++i) {
    const double a = 2 * std::numbers::pi * i / kCells;
    for (const double s : {-20.0, 20.0}) {
      const double r = 100 + s * std::cos(a / 2);
      text += "v " + std::to_string(r * std::cos(a)) + " " + std::to_string(r * std::sin(a)) + " " +
              std::to_string(s * std::sin(a / 2)) + "\n";
    }
  }
  for (int i = 0; i + 1 < kCells; ++i) {
    const int a = 2 * i + 1;
    text += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(a + 3) + " " +
            std::to_string(a + 2) + "\n";
  }
  text += "f " + std::to_string(2 * kCells - 1) + " " + std::to_string(2 * kCells) + " 1 2\n";
  const Health h = read_text(text).health;
  EXPECT_FALSE(h.orientable);
  EXPECT_THAT(h.blockers,
              ElementsAre(AllOf(HasSubstr("one side only"), HasSubstr("lines "), HasSubstr(" mm"))));
}

TEST(MeshHealth, BlocksThreeFacesOnAnEdgeWithTheObjsNumbers) {
  const Health h =
      read_text(
          "v 9 9 9\nv 0 0 0\nv 0 0 100\nv 100 0 0\nv -50 80 0\nv -50 -80 0\nf 2 3 4\nf 3 2 5\nf 2 3 6\n")
          .health;
  EXPECT_EQ(h.non_manifold_edges, 1U);
  EXPECT_THAT(h.blockers, ElementsAre(AllOf(HasSubstr("with 3 between vertex 2 (0.000, 0.000, 0.000) mm"),
                                            HasSubstr("vertex 3 (0.000, 0.000, 100.000) mm"))));
}

TEST(MeshHealth, PartsSheetsThatTouchInAPoint) {
  // Two triangles with a corner in common, and a tetrahedron standing on that corner.
  const DesignSurface d = read_text(
      "v 0 0 0\nv 100 0 0\nv 100 50 0\nv -100 0 0\nv -100 -50 0\nv 30 0 90\nv -10 30 90\nv -10 -30 90\n"
      "f 1 2 3\nf 1 4 5\nf 1 6 7\nf 1 7 8\nf 1 8 6\nf 6 8 7\n");
  EXPECT_EQ(d.health.non_manifold_vertices, 1U);
  EXPECT_EQ(d.health.vertices, 10U);
  EXPECT_EQ(d.health.components, 3U);
  EXPECT_EQ(d.health.border_loops, 2U);
  EXPECT_THAT(d.health.blockers, IsEmpty());
  EXPECT_THAT(d.health.repairs, ElementsAre(AllOf(HasSubstr("1 vertex"), HasSubstr("vertex 1 (0.000"))));
}

TEST(MeshHealth, TakesOutNeedlesWithoutOpeningAGap) {
  // A square in two halves whose common edge has two more vertices on the one side, filled with needles.
  const DesignSurface d = read_text(
      "v 0 0 0\nv 90 0 0\nv 90 90 0\nv 0 90 0\nv 30 30 0\nv 60 60 0\n"
      "f 1 2 5\nf 5 2 6\nf 6 2 3\nf 1 3 4\nf 1 5 6\nf 1 6 3\n");
  EXPECT_EQ(d.health.degenerate_faces, 2U);
  EXPECT_EQ(d.health.components, 1U);
  EXPECT_EQ(d.health.border_loops, 1U);
  EXPECT_NEAR(d.health.border_length_mm, 360, 1e-9);
  EXPECT_NEAR(d.health.area_mm2, 8100, 1e-9);
  EXPECT_THAT(d.health.blockers, IsEmpty());
  EXPECT_THAT(d.health.repairs, ElementsAre(HasSubstr("dropped 2 faces without area")));
}

TEST(MeshHealth, TakesOutNeedlesFoldedOnEachOther) {
  // Two strips on one line, x = 0, whose needles come to lie on the same three corners while edges are
  // turned.
  const std::string strips = "v 0 0 0\nv 0 40 1\nv 0 80 2\nv 0 120 3\nv 0 160 4\nf 1 3 4 2\nf 2 4 5 3\n";
  EXPECT_THROW((void)read_text(strips), MeshError);
  const DesignSurface d = read_text(strips + "v 50 0 0\nv 90 0 0\nv 90 40 0\nf 6 7 8\n");
  EXPECT_EQ(d.health.triangles, 1U);
  EXPECT_EQ(d.health.border_loops, 1U);
  EXPECT_THAT(d.health.blockers, IsEmpty());
}

TEST(MeshHealth, TakesFacesInAnyOrder) {
  TriangleSoup mesh = tube(100, 200, 24, 10);
  const Health sorted = read_mesh(mesh).health;
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    const Health h = read_mesh(mesh).health;
    EXPECT_THAT(h.blockers, IsEmpty());
    EXPECT_THAT(h.repairs, IsEmpty());
    EXPECT_EQ(h.border_loops, sorted.border_loops);
  }
}

TEST(MeshHealth, AgreesWithEulersFormulaOnRandomSheets) {
  std::mt19937 random(11);
  for (int round = 0; round < 30; ++round) {
    std::bernoulli_distribution filled(0.7);
    std::vector<bool> cells(144);
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = filled(random);
    const auto flat = [](double s, double t) { return Eigen::Vector3d(120 * s, 120 * t, 0); };
    const DesignSurface d = read_mesh(
        grid(12, 12, flat, [&](int i, int j) { return cells[static_cast<std::size_t>(12 * j + i)]; }));
    ASSERT_THAT(d.health.blockers, IsEmpty());
    std::set<std::pair<int, int>> edges;
    for (const auto& t : d.mesh.triangles()) {
      for (std::size_t i = 0; i < 3; ++i) edges.insert(std::minmax({t[i], t[(i + 1) % 3]}));
    }
    // Flat sheets: V - E + F = 2 components - border loops.
    const auto euler =
        static_cast<long>(d.health.vertices + d.health.triangles) - static_cast<long>(edges.size());
    EXPECT_EQ(euler, 2 * static_cast<long>(d.health.components) - static_cast<long>(d.health.border_loops));
  }
}

}  // namespace
}  // namespace hotblade::surface
