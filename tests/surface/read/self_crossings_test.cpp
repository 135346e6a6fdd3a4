#include "surface/read/self_crossings.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <random>
#include <variant>

#include "surface/read/spread_fans.hpp"
#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// The definition, in exact numbers: the common part is a segment through the inside of both triangles, or has
// an area.
class Oracle {
 public:
  using K = CGAL::Exact_predicates_exact_constructions_kernel;

  explicit Oracle(const TriangleSoup& mesh) : mesh_(mesh) {}

  [[nodiscard]] bool cross(std::size_t f, std::size_t g) const {
    const K::Triangle_3 t = triangle(f), u = triangle(g);
    const auto common = CGAL::intersection(t, u);
    if (!common) return false;
    if (const auto* segment = boost::get<K::Segment_3>(&*common)) {
      const K::Point_3 middle = CGAL::midpoint(segment->source(), segment->target());
      return inside(t, middle) && inside(u, middle);
    }
    return boost::get<K::Point_3>(&*common) == nullptr;
  }

 private:
  [[nodiscard]] K::Triangle_3 triangle(std::size_t f) const {
    std::array<K::Point_3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d& v = mesh_.vertices[static_cast<std::size_t>(mesh_.triangles[f][i])];
      p[i] = {v.x(), v.y(), v.z()};
    }
    return {p[0], p[1], p[2]};
  }
  static bool inside(const K::Triangle_3& t, const K::Point_3& p) {
    for (int i = 0; i < 3; ++i) {
      if (K::Segment_3(t[i], t[i + 1]).has_on(p)) return false;
    }
    return true;
  }
  const TriangleSoup& mesh_;
};

std::size_t crossings_by_oracle(const TriangleSoup& mesh) {
  const Oracle oracle(mesh);
  std::size_t pairs = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (std::size_t g = f + 1; g < mesh.triangles.size(); ++g) pairs += oracle.cross(f, g) ? 1U : 0U;
  }
  return pairs;
}

// Triangles over few vertices on a coarse grid: shared corners and edges, touching and coplanar ones abound.
TriangleSoup random_soup(std::mt19937& random, int vertices, int triangles, int cells) {
  std::uniform_int_distribution<int> coordinate(0, cells), vertex(0, vertices - 1);
  TriangleSoup mesh;
  for (int v = 0; v < vertices; ++v)
    mesh.vertices.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  while (static_cast<int>(mesh.triangles.size()) < triangles) {
    const std::array<int, 3> t{vertex(random), vertex(random), vertex(random)};
    const auto at = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
    if ((at(1) - at(0)).cross(at(2) - at(0)).norm() > 0) mesh.triangles.push_back(t);
  }
  return mesh;
}

TEST(SelfCrossings, AgreeWithExactIntersectionsOnSmallGrids) {
  std::mt19937 random(11);
  std::size_t found = 0;
  for (int k = 0; k < 60; ++k) {
    const TriangleSoup mesh = random_soup(random, 12, 12, 3);
    const SelfCrossings crossings = find_self_crossings(TriangleMesh(mesh));
    ASSERT_EQ(crossings.pairs, crossings_by_oracle(mesh)) << k;
    if (crossings.pairs > 0) {
      EXPECT_TRUE(Oracle(mesh).cross(static_cast<std::size_t>(crossings.faces[0]),
                                     static_cast<std::size_t>(crossings.faces[1])));
    }
    found += crossings.pairs;
  }
  EXPECT_GT(found, 500u);  // the meshes do cross
}

// Flat but for rounding, and askew: neighbours at every angle, folded back on each other, long needles among
// them. What plain numbers tell must be what exact ones say of these very coordinates.
TEST(SelfCrossings, AgreeWithExactIntersectionsWhereFacesAreNearlyFlat) {
  std::mt19937 random(12);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t found = 0;
  for (int k = 0; k < 60; ++k) {
    TriangleSoup mesh = random_soup(random, 12, 12, 4);
    const double thick = std::pow(10.0, -4 * (k % 5)), wide = k % 2 == 0 ? 1 : 1e-5,
                 far = k % 3 == 0 ? 1e5 : 0;
    for (Eigen::Vector3d& p : mesh.vertices) {
      p = turn * Eigen::Vector3d(p.x(), wide * p.y(), thick * wide * p.z() + 1e-13 * unit(random));
      p.array() += far;
    }
    std::erase_if(mesh.triangles, [&](const auto& t) {
      const auto at = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
      const Eigen::Vector3d a = at(1) - at(0), b = at(2) - at(0);
      return a.cross(b).norm() <= 1e-9 * a.norm() * b.norm();
    });
    const SelfCrossings crossings = find_self_crossings(TriangleMesh(mesh));
    ASSERT_EQ(crossings.pairs, crossings_by_oracle(mesh)) << k;
    found += crossings.pairs;
  }
  EXPECT_GT(found, 300u);
}

TEST(SelfCrossings, AreNoneOnSurfacesThatOnlyTouchThemselves) {
  EXPECT_EQ(find_self_crossings(TriangleMesh(dome(500, 300, 12))).pairs, 0u);
  EXPECT_EQ(find_self_crossings(TriangleMesh(tube(100, 300, 24, 6))).pairs, 0u);
  // A saddle: neighbours pass through each other's planes everywhere.
  const TriangleMesh saddle(grid(20, 20, [](double s, double t) {
    return Eigen::Vector3d(1000 * s, 1000 * t, 800 * (s - 0.5) * (t - 0.5));
  }));
  EXPECT_EQ(find_self_crossings(saddle).pairs, 0u);
}

TEST(SelfCrossings, AreNoLongerSearchedWhereTheWatchThrows) {
  const TriangleMesh mesh(dome(500, 300, 40));
  std::atomic<int> looks = 0;
  (void)find_self_crossings(mesh, [&] { ++looks; });
  EXPECT_GT(looks, 50);
  const int whole = looks.exchange(0);
  struct Ended {};
  const auto ends = [&] {
    if (++looks > 10) throw Ended{};
  };
  EXPECT_THROW((void)find_self_crossings(mesh, ends), Ended);
  EXPECT_LT(looks, whole);
}

TEST(SelfCrossings, AreToldWithLinesAndPlace) {
  // Two plates that cross along x = 50.
  const std::string text =
      "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\nv 50 0 -50\nv 50 0 50\nv 50 100 50\nv 50 100 -50\n"
      "f 1 2 3\nf 1 3 4\nf 5 6 7\nf 5 7 8\n";
  const DesignSurface design = read_text(text);
  EXPECT_THAT(self_crossings_text(design), AllOf(HasSubstr("pairs of faces cross"),
                                                 HasSubstr("lines 9 and 11"), HasSubstr("near (50.000, ")));
  EXPECT_EQ(self_crossings_text(read_text("v 0 0 0\nv 9 0 0\nv 9 9 0\nf 1 2 3\n")), "");
}

// A fan that is said to be spread has no two faces that cross, whatever its vertices; a smooth one is said to
// be.
TEST(SpreadFans, HaveNoFacesThatCross) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> any(-1, 1);
  int spread = 0, folded = 0;
  for (int round = 0; round < 3000; ++round) {
    const int rim = 3 + round % 6;
    TriangleSoup fan{{Eigen::Vector3d(0, 0, 0.3 * any(random))}, {}};
    const double turns = round % 7 == 0 ? 2 : 1, rough = 0.2 * (round % 5);
    for (int i = 0; i < rim; ++i) {
      const double angle = turns * 2 * std::numbers::pi * i / rim;
      fan.vertices.emplace_back(std::cos(angle) + rough * any(random), std::sin(angle) + rough * any(random),
                                0.3 * any(random));
      fan.triangles.push_back({0, 1 + i, 1 + (i + 1) % rim});
    }
    const TriangleMesh mesh(fan);
    const bool said = SpreadFans(mesh).holds(0);
    const std::size_t crossing = find_self_crossings(mesh).pairs;
    // Without the centre's face among them the faces are compared by exact predicates.
    TriangleSoup parted{{}, {}};
    for (const auto& t : fan.triangles) {
      for (const int v : t) parted.vertices.push_back(fan.vertices[static_cast<std::size_t>(v)]);
      const auto last = static_cast<int>(parted.vertices.size());
      parted.triangles.push_back({last - 3, last - 2, last - 1});
    }
    EXPECT_EQ(find_self_crossings(TriangleMesh(parted)).pairs, crossing) << round;
    if (said) {
      EXPECT_EQ(crossing, 0U) << round;
    }
    if (rough == 0 && turns == 1) {
      EXPECT_TRUE(said) << round;
    }
    spread += said ? 1 : 0;
    folded += crossing > 0 ? 1 : 0;
  }
  EXPECT_GT(spread, 1000);
  EXPECT_GT(folded, 100);
}

}  // namespace
}  // namespace hotblade::surface
