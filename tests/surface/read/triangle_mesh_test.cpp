#include "surface/read/triangle_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <random>

#include "surface/read/half_edges.hpp"
#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Corners by their edges' vertices, whichever way round.
using Edges = std::map<std::array<int, 2>, std::vector<int>>;

Edges edges_of(const TriangleSoup& soup) {
  Edges edges;
  for (int c = 0; c < 3 * static_cast<int>(soup.triangles.size()); ++c) {
    const auto& t = soup.triangles[static_cast<std::size_t>(c / 3)];
    const int a = t[static_cast<std::size_t>(c % 3)], b = t[static_cast<std::size_t>((c + 1) % 3)];
    edges[{std::min(a, b), std::max(a, b)}].push_back(c);
  }
  return edges;
}

// The definition of neighbours, border and crowded edges, edge by edge.
void expect_neighbours(const TriangleSoup& soup) {
  const TriangleMesh mesh(soup);
  const HalfEdges::Crowded& crowded = mesh.half_edges().crowded();
  std::vector<int> border;
  std::size_t crowded_edges = 0;
  for (const auto& [edge, corners] : edges_of(soup)) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const int beyond = corners.size() == 2 ? corners[1 - i] : TriangleMesh::kNone;
      ASSERT_EQ(mesh.beyond(corners[i]), beyond) << corners[i];
      if (beyond == TriangleMesh::kNone) border.push_back(corners[i]);
    }
    EXPECT_TRUE(mesh.joined(edge[0], edge[1]) && mesh.joined(edge[1], edge[0]));
    if (corners.size() > 2 && crowded_edges++ == 0) {
      EXPECT_EQ(crowded.first, edge);
      EXPECT_EQ(crowded.triangles, corners.size());
    }
  }
  EXPECT_EQ(crowded.edges, crowded_edges);
  std::sort(border.begin(), border.end());
  EXPECT_EQ(mesh.border(), border);
}

void shuffle(TriangleSoup& soup, std::mt19937& random) {
  std::shuffle(soup.triangles.begin(), soup.triangles.end(), random);
  for (auto& t : soup.triangles) std::rotate(t.begin(), t.begin() + static_cast<int>(random() % 3), t.end());
}

TEST(TriangleMesh, KeepsVerticesTrianglesAndCornersInTheirOrder) {
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    TriangleSoup soup = tube(100, 200, 12, 5);
    shuffle(soup, random);
    const TriangleMesh mesh(soup);
    EXPECT_EQ(mesh.soup().vertices, soup.vertices);
    EXPECT_EQ(mesh.soup().triangles, soup.triangles);
    const HalfEdges& half_edges = mesh.half_edges();
    for (int c = 0; c < 3 * static_cast<int>(soup.triangles.size()); ++c) {
      const auto h = half_edges.at_corner(c);
      ASSERT_EQ(half_edges.corner_of(h), c);
      ASSERT_EQ(half_edges.mesh().from_vertex_handle(h).idx(), vertex_at(mesh, c));
    }
  }
}

TEST(TriangleMesh, FindsTheNeighboursOfSurfacesWhoseTrianglesRunAnyWayRound) {
  std::mt19937 random(4);
  for (int round = 0; round < 40; ++round) {
    TriangleSoup soup =
        grid(8, 6, [](double s, double t) { return Eigen::Vector3d(80 * s, 60 * t, 9 * s * t); });
    shuffle(soup, random);
    std::bernoulli_distribution over(0.05 * (round % 11));
    for (auto& t : soup.triangles) {
      if (over(random)) std::swap(t[0], t[2]);
    }
    expect_neighbours(soup);
  }
}

TEST(TriangleMesh, FindsTheNeighboursInSoupsWithCrowdedEdges) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    const int vertices = 4 + round % 9;
    std::uniform_int_distribution<int> vertex(0, vertices - 1);
    TriangleSoup soup;
    for (int v = 0; v < vertices; ++v) soup.vertices.emplace_back(v, v * v, 1);
    for (int f = 0; f < 3 + round % 17; ++f) {
      std::array<int, 3> t{};
      while (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
        t = {vertex(random), vertex(random), vertex(random)};
      soup.triangles.push_back(t);
    }
    expect_neighbours(soup);
  }
}

TEST(TriangleMesh, FollowsBordersInTheSenseOfTheTriangles) {
  const auto flat = [](double s, double t) { return Eigen::Vector3d(30 * s, 30 * t, 0); };
  const TriangleMesh frame(grid(3, 3, flat, [](int i, int j) { return i != 1 || j != 1; }));
  const auto loops = frame.border_loops();
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_EQ(loops[0].size() + loops[1].size(), frame.border().size());
  for (const std::vector<int>& loop : loops) {
    EXPECT_EQ(loop.front(), *std::min_element(loop.begin(), loop.end()));
    double turned = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int c = loop[i], next = loop[(i + 1) % loop.size()];
      EXPECT_EQ(vertex_at(frame, next_corner(c)), vertex_at(frame, next));
      const auto at = [&](int corner) {
        return frame.vertices()[static_cast<std::size_t>(vertex_at(frame, corner))];
      };
      turned += at(c).x() * at(next).y() - at(c).y() * at(next).x();
    }
    // Twice the area inside: counter-clockwise outside, clockwise round the hole.
    EXPECT_NEAR(turned, &loop == &loops.front() ? 1800 : -200, 1e-9);
  }
  EXPECT_THAT(TriangleMesh(TriangleSoup{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                        {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}})
                  .border_loops(),
              IsEmpty());
}

TEST(TriangleMesh, LastsAsLongAsItsCopies) {
  TriangleMesh copy;
  {
    const TriangleMesh mesh(dome(500, 100, 4));
    copy = mesh;
  }
  EXPECT_EQ(copy.soup().vertices, dome(500, 100, 4).vertices);
  EXPECT_EQ(copy.beyond(0), TriangleMesh::kNone);
}

TEST(TriangleMesh, RefusesTrianglesThatAreNone) {
  const std::vector<Eigen::Vector3d> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THROW(TriangleMesh({corners, {{0, 1, 3}}}), std::logic_error);
  EXPECT_THROW(TriangleMesh({corners, {{0, -1, 2}}}), std::logic_error);
  EXPECT_THROW(TriangleMesh({corners, {{0, 1, 1}}}), std::logic_error);
  EXPECT_THAT(TriangleMesh({corners, {{0, 1, 2}}}).border(), ElementsAre(0, 1, 2));
}

TEST(AreaCentre, MovesAndTurnsWithTheDesignWhateverTheOrderOfItsTriangles) {
  // A pyramid's roof without one side, so that no symmetry helps.
  const TriangleSoup roof{{{0, 0, 0}, {900, 0, 0}, {900, 500, 0}, {0, 500, 0}, {300, 200, 400}},
                          {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}}};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double area = 0;
  for (const auto& t : roof.triangles) {
    const auto at = [&](std::size_t i) { return roof.vertices[static_cast<std::size_t>(t[i])]; };
    const double part = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
    sum += part / 3 * (at(0) + at(1) + at(2));
    area += part;
  }
  const Eigen::Vector3d centre = area_centre(TriangleMesh(roof));
  EXPECT_LT((centre - sum / area).norm(), 1e-9);
  TriangleSoup shuffled = roof;
  std::reverse(shuffled.triangles.begin(), shuffled.triangles.end());
  for (auto& t : shuffled.triangles) std::rotate(t.begin(), t.begin() + 1, t.end());
  EXPECT_EQ(area_centre(TriangleMesh(shuffled)), centre);
  TriangleSoup moved = roof;
  const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  const Eigen::Vector3d by(1e6, -2e6, 3e5);
  for (Eigen::Vector3d& p : moved.vertices) p = turn * p + by;
  EXPECT_LT((area_centre(TriangleMesh(moved)) - (turn * centre + by)).norm(), 1e-8);
}

TEST(AreaCentre, IsAVertexWhereThereIsNoArea) {
  const TriangleSoup line{{{1, 2, 3}, {2, 3, 4}, {3, 4, 5}}, {{0, 1, 2}}};
  EXPECT_EQ(area_centre(TriangleMesh(line)), Eigen::Vector3d(1, 2, 3));
  EXPECT_THROW((void)area_centre(TriangleMesh(TriangleSoup{})), std::logic_error);
}

}  // namespace
}  // namespace hotblade::surface
