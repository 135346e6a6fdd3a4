#include "surface/read/near_faces.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <mutex>
#include <random>
#include <set>

#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

using Pairs = std::multiset<std::array<int, 2>>;

Pairs found_in(const TriangleSoup& mesh) {
  const NearFaces near(mesh.vertices, mesh.triangles);
  Pairs pairs;
  for (std::size_t i = 0; i < near.portions(); ++i) {
    near.visit(i, [&](int f, int g) { pairs.insert({std::min(f, g), std::max(f, g)}); });
  }
  return pairs;
}

Eigen::AlignedBox3d box_of(const TriangleSoup& mesh, std::size_t f, double more) {
  Eigen::AlignedBox3d box;
  for (const int v : mesh.triangles[f]) box.extend(mesh.vertices[static_cast<std::size_t>(v)]);
  const Eigen::Vector3d wide = Eigen::Vector3d::Constant(more);
  return {box.min() - wide, box.max() + wide};
}

// All pairs, one by one; boxes grown by `more` on every side.
Pairs brute_force(const TriangleSoup& mesh, double more) {
  Pairs pairs;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (std::size_t g = f + 1; g < mesh.triangles.size(); ++g) {
      if (box_of(mesh, f, more).intersects(box_of(mesh, g, more)))
        pairs.insert({static_cast<int>(f), static_cast<int>(g)});
    }
  }
  return pairs;
}

TriangleSoup soup(std::mt19937& random, int triangles, double size, double offset) {
  std::uniform_real_distribution<double> place(offset, offset + 100), away(-size, size);
  TriangleSoup mesh;
  for (int f = 0; f < triangles; ++f) {
    const Eigen::Vector3d p(place(random), place(random), 0.1 * place(random));
    for (int i = 0; i < 3; ++i)
      mesh.vertices.push_back(p + Eigen::Vector3d(away(random), away(random), away(random)));
    mesh.triangles.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return mesh;
}

TEST(NearFaces, AreThePairsWhoseBoxesMeetEachOnce) {
  std::mt19937 random(3);
  for (const int triangles : {1, 2, 3, 4, 5, 8, 9, 33, 300}) {
    for (const double size : {0.5, 5.0, 50.0}) {
      for (const double offset : {0.0, 1e6}) {
        const TriangleSoup mesh = soup(random, triangles, size, offset);
        const Pairs found = found_in(mesh), least = brute_force(mesh, 0),
                    most = brute_force(mesh, 1e-7 * (offset + 200));  // single precision
        EXPECT_TRUE(std::includes(found.begin(), found.end(), least.begin(), least.end()));
        EXPECT_TRUE(std::includes(most.begin(), most.end(), found.begin(), found.end()));
        for (const auto& pair : found) ASSERT_EQ(found.count(pair), 1U);
      }
    }
  }
}

// Sets of every size are left out, told by their first face: pairs within them are not found, all others are.
TEST(NearFaces, AreAllButThoseOfSetsThatAreLeftOut) {
  const TriangleSoup mesh = grid(90, 90, [](double s, double t) {
    return Eigen::Vector3d(1000 * s, 1000 * t, 300 * s * s + 200 * s * t);
  });
  NearFaces near(mesh.vertices, mesh.triangles);
  std::vector<int> set(mesh.triangles.size(), -1);
  std::set<std::size_t> sizes;
  std::mutex one_at_a_time;
  near.leave_out([&](std::size_t first, std::size_t count) {
    const int face = near.order()[first];
    if (face % 3 != 0) return false;
    const std::lock_guard lock(one_at_a_time);
    for (std::size_t i = first; i < first + count; ++i) set[static_cast<std::size_t>(near.order()[i])] = face;
    sizes.insert(count);
    return true;
  });
  EXPECT_GE(sizes.size(), 2U);
  const auto left_out = [&](const std::array<int, 2>& pair) {
    const int one = set[static_cast<std::size_t>(pair[0])], other = set[static_cast<std::size_t>(pair[1])];
    return one >= 0 && one == other;
  };
  Pairs expected = found_in(mesh), found;
  const std::size_t all = expected.size();
  std::erase_if(expected, left_out);
  for (std::size_t i = 0; i < near.portions(); ++i)
    near.visit(i, [&](int f, int g) { found.insert({std::min(f, g), std::max(f, g)}); });
  EXPECT_EQ(found, expected);
  EXPECT_LT(found.size(), all - all / 5);
}

TEST(NearFaces, AreInProportionToTheFacesOfASurface) {
  const auto near = [](int cells) {
    return static_cast<double>(found_in(grid(cells, cells, [](double s, double t) {
                                 return Eigen::Vector3d(1000 * s, 1000 * t, 300 * s * s + 200 * s * t);
                               })).size());
  };
  EXPECT_NEAR(near(80) / near(40), 4, 0.4);
}

TEST(NearFaces, AreNoneOfAnEmptyMeshAndRefuseWildIndices) {
  EXPECT_EQ(NearFaces({}, {}).portions(), 0U);
  const TriangleSoup wild{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 3}}};
  EXPECT_THROW(NearFaces(wild.vertices, wild.triangles), std::logic_error);
}

}  // namespace
}  // namespace hotblade::surface
