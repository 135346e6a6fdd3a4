#include "surface/read/single_layers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "surface/read/half_edges.hpp"
#include "surface/read/self_crossings.hpp"
#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

std::vector<int> every_face(const TriangleMesh& mesh) {
  std::vector<int> order(mesh.triangles().size());
  std::iota(order.begin(), order.end(), 0);
  return order;
}

bool hold(const TriangleSoup& soup) {
  const TriangleMesh mesh(soup);
  const std::vector<int> order = every_face(mesh);
  return SingleLayers(mesh, order).holds(0, order.size());
}

// A part of a ramp about the z axis, upwards all over: `turns` of it, from radius 10 to 20.
TriangleSoup ramp(double turns, double rise) {
  return grid(static_cast<int>(40 * turns), 4, [=](double s, double t) {
    const double angle = 2 * std::numbers::pi * turns * s, r = 20 - 10 * t;
    return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), rise * turns * s);
  });
}

TriangleSoup moved(TriangleSoup soup, const Eigen::Vector3d& by) {
  for (Eigen::Vector3d& p : soup.vertices) p += by;
  return soup;
}

TriangleSoup together(TriangleSoup one, const TriangleSoup& other) {
  const auto before = static_cast<int>(one.vertices.size());
  one.vertices.insert(one.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles)
    one.triangles.push_back({t[0] + before, t[1] + before, t[2] + before});
  return one;
}

TriangleSoup plate(int cells, double size, const std::function<bool(int, int)>& keep) {
  return grid(
      cells, cells, [=](double s, double t) { return Eigen::Vector3d(size * s, size * t, 0); }, keep);
}
TriangleSoup plate(int cells, double size) {
  return plate(cells, size, [](int, int) { return true; });
}

TEST(SingleLayers, HoldWhereEveryPlaceIsCoveredOnce) {
  EXPECT_TRUE(hold(plate(8, 100)));
  EXPECT_TRUE(hold(dome(500, 300, 12)));
  EXPECT_TRUE(hold(ramp(0.9, 30)));
  const TriangleSoup framed = plate(8, 80, [](int i, int j) { return i < 2 || i > 5 || j < 2 || j > 5; });
  EXPECT_TRUE(hold(framed));
  EXPECT_TRUE(hold(together(framed, moved(plate(3, 20), {30, 30, 5}))));  // in the window
  EXPECT_TRUE(hold(together(plate(4, 20), moved(plate(4, 20), {40, 3, 5}))));
}

TEST(SingleLayers, AreNotSaidWhereAPlaceIsCoveredTwice) {
  EXPECT_FALSE(hold(ramp(1.5, 30)));
  EXPECT_FALSE(hold(ramp(3, 30)));
  EXPECT_FALSE(hold(together(plate(8, 100), moved(plate(3, 20), {30, 30, 5}))));  // above its middle
  EXPECT_FALSE(hold(together(plate(4, 20), moved(plate(4, 20), {15, 3, 5}))));    // above its edge
  const TriangleSoup framed = plate(8, 80, [](int i, int j) { return i < 2 || i > 5 || j < 2 || j > 5; });
  EXPECT_FALSE(hold(together(framed, moved(plate(5, 44), {18, 18, 5}))));  // bigger than the window
}

TEST(SingleLayers, AreNotSaidOfFacesThatNoAxisSeesFromTheirFront) {
  EXPECT_FALSE(hold(tube(100, 300, 24, 6)));
  TriangleSoup turned = plate(2, 20);
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  const TriangleMesh mesh(turned);
  ASSERT_FALSE(mesh.half_edges().plain());
  EXPECT_THROW(SingleLayers(mesh, every_face(mesh)), std::logic_error);
}

// Any faces of a flat grid lie in one layer, however they are strewn: with holes, in pieces that touch in
// corners or lie in each other's holes, straight or askew, from either side.
TEST(SingleLayers, HoldForAnyFacesOfAPlane) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-0.2, 0.2);
  for (int round = 0; round < 400; ++round) {
    const double rough = round % 2;
    TriangleSoup soup = plate(9, 9);
    for (Eigen::Vector3d& p : soup.vertices)
      p += rough * Eigen::Vector3d(any(random), any(random), any(random));
    if (round % 3 == 1)
      for (auto& t : soup.triangles) std::swap(t[0], t[1]);
    if (round % 4 > 1) {
      for (Eigen::Vector3d& p : soup.vertices) p = Eigen::Vector3d(p.z(), p.x(), p.y());
    }
    const TriangleMesh mesh(soup);
    std::vector<int> order = every_face(mesh);
    std::shuffle(order.begin(), order.end(), random);
    const SingleLayers layers(mesh, order);
    const std::size_t first = random() % 60, count = 1 + random() % 100;
    EXPECT_TRUE(layers.holds(first, count)) << round;
  }
}

// What plain numbers tell of the faces' areas: covered twice where two of them have a place in common.
bool overlap(const TriangleSoup& soup, int f, int g) {
  const auto corner = [&](int face, std::size_t i) -> Eigen::Vector2d {
    const auto& t = soup.triangles[static_cast<std::size_t>(face)];
    return soup.vertices[static_cast<std::size_t>(t[i % 3])].head<2>();
  };
  // Counter-clockwise triangles are apart where all of one lies right of an edge of the other, but for 1e-9.
  const auto parts = [&](int one, int other) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector2d a = corner(one, i), along = corner(one, i + 1) - a;
      double most = -1e300;
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector2d to = corner(other, k) - a;
        most = std::max(most, along.x() * to.y() - along.y() * to.x());
      }
      if (most < 1e-9) return true;
    }
    return false;
  };
  return !parts(f, g) && !parts(g, f);
}

// Strewn faces of a ramp of one and a half turns, pieces among them that cover others.
TEST(SingleLayers, AreNeverSaidOfFacesThatCoverEachOther) {
  std::mt19937 random(7);
  const TriangleSoup soup = ramp(1.5, 30);
  const TriangleMesh mesh(soup);
  int held = 0, covering = 0;
  for (int round = 0; round < 600; ++round) {
    std::vector<int> order = every_face(mesh);
    if (round % 2 == 0) {
      std::shuffle(order.begin(), order.end(), random);
    } else {
      std::rotate(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(random() % order.size()),
                  order.end());
    }
    const SingleLayers layers(mesh, order);
    const std::size_t count = 1 + random() % (round % 4 < 2 ? 40 : 400);
    bool covered = false;
    for (std::size_t i = 0; i < count && !covered; ++i)
      for (std::size_t k = 0; k < i && !covered; ++k) covered = overlap(soup, order[i], order[k]);
    const bool said = layers.holds(0, count);
    EXPECT_FALSE(said && covered) << round;
    held += said ? 1 : 0;
    covering += covered ? 1 : 0;
  }
  EXPECT_GT(held, 100);
  EXPECT_GT(covering, 100);
}

// The same mesh with two faces far off that touch in a corner is no plain surface, and all of its faces are
// compared: the crossings are the same, turned and shuffled as it may be.
TEST(SingleLayers, LeaveTheCrossingsOfAMeshAsTheyAre) {
  std::mt19937 random(9);
  const TriangleSoup touching{{{9e3, 0, 0}, {9e3, 1, 0}, {9e3, 0, 1}, {9e3, -1, 0}, {9e3, 0, -1}},
                              {{0, 1, 2}, {0, 3, 4}}};
  const auto waves = [](double high) {
    return grid(36, 36, [=](double s, double t) {
      return Eigen::Vector3d(100 * s, 100 * t, high * std::sin(9 * s) * std::sin(7 * t) + 3 * s);
    });
  };
  std::size_t crossing = 0;
  for (int round = 0; round < 12; ++round) {
    TriangleSoup soup = waves(round % 4 == 0 ? 0 : 12);
    // A second sheet, beside the first one, through it or upright in it.
    if (round % 3 == 1) soup = together(soup, moved(waves(5), {3, 4, 2}));
    if (round % 3 == 2) soup = together(soup, moved(ramp(2.5, 30), {50, 50, -20}));
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.9 * round, Eigen::Vector3d(1, 2, round).normalized()).toRotationMatrix();
    for (Eigen::Vector3d& p : soup.vertices) p = turn * p;
    std::shuffle(soup.triangles.begin(), soup.triangles.end(), random);
    const TriangleMesh plain(soup), other(together(soup, touching));
    ASSERT_TRUE(plain.half_edges().plain());
    ASSERT_FALSE(other.half_edges().plain());
    const SelfCrossings found = find_self_crossings(plain), all = find_self_crossings(other);
    EXPECT_EQ(found.pairs, all.pairs) << round;
    EXPECT_EQ(found.faces, all.faces) << round;
    EXPECT_EQ(found.at, all.at) << round;
    crossing += found.pairs > 0 ? 1U : 0U;
  }
  EXPECT_GE(crossing, 6U);
}

}  // namespace
}  // namespace hotblade::surface
