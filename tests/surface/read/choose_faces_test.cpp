#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "surface/read/stitches.hpp"
#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A box of 100 x 60 x 40 mm, closed, faces outwards; its top is in group "top" of object "my mould".
const std::string kBox =
    "v 0 0 0\nv 100 0 0\nv 100 60 0\nv 0 60 0\nv 0 0 40\nv 100 0 40\nv 100 60 40\nv 0 60 40\n"
    "f 4 3 2 1\no my mould\ng top skin\nf 5 6 7 8\ng walls skin\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n"
    "o rest\nf 4 1 5 8\n";

ReadOptions of_group(const std::string& group) {
  ReadOptions options{"mm", 'z'};
  options.group = group;
  return options;
}

TEST(ReadGroup, TakesTheFacesOfAGroupOrAnObject) {
  EXPECT_DOUBLE_EQ(read_text(kBox).health.area_mm2, 2 * (6000 + 4000 + 2400));
  EXPECT_DOUBLE_EQ(read_text(kBox, of_group("top")).health.area_mm2, 6000);
  EXPECT_DOUBLE_EQ(read_text(kBox, of_group("skin")).health.area_mm2, 6000 + 2 * 4000 + 2 * 2400);
  EXPECT_DOUBLE_EQ(read_text(kBox, of_group("top skin")).health.area_mm2, 6000);  // the words as one name
  EXPECT_DOUBLE_EQ(read_text(kBox, of_group("my mould")).health.area_mm2, 6000 + 2 * 4000 + 2400);
  EXPECT_DOUBLE_EQ(read_text(kBox, of_group("rest")).health.area_mm2, 2400);
  const Health health = read_text(kBox, of_group("top")).health;
  EXPECT_EQ(health.file_faces, 6u);
  EXPECT_THAT(health.repairs, Contains(HasSubstr("took the 1 of 6 faces in group top")));
}

TEST(ReadGroup, SaysWhichGroupsThereAre) {
  const auto error_of = [](const std::string& text) {
    return message_of<MeshError>([&] { static_cast<void>(read_text(text, of_group("lid"))); });
  };
  EXPECT_THAT(error_of(kBox), AllOf(HasSubstr("no faces in group 'lid'"),
                                    HasSubstr("choose one of my mould, rest, skin, top, walls")));
  EXPECT_THAT(error_of("v 0 0 0\nv 9 0 0\nv 9 9 0\nf 1 2 3\n"), HasSubstr("leave design.group empty"));
}

TEST(ReadFacing, TakesTheFacesThatLookInADirection) {
  ReadOptions options{"mm", 'z'};
  options.facing = Eigen::Vector3d(0, 0, 5);
  EXPECT_DOUBLE_EQ(read_text(kBox, options).health.area_mm2, 6000);
  EXPECT_FALSE(read_text(kBox, options).health.closed);
  options.facing = Eigen::Vector3d(1, 0, 1);  // 45 degrees from the top and from one wall
  EXPECT_DOUBLE_EQ(read_text(kBox, options).health.area_mm2, 6000 + 2400);
  options.facing_max_rad = 0.7;
  EXPECT_THAT(message_of<MeshError>([&] { static_cast<void>(read_text(kBox, options)); }),
              HasSubstr("no face looks in the direction"));
}

// A plate in two halves whose borders along x = 50 miss each other by `gap`, in `rows` cells.
std::string halves(double gap, int rows) {
  TriangleSoup both = grid(5, rows, [](double s, double t) { return Eigen::Vector3d(50 * s, 100 * t, 0); });
  const TriangleSoup right =
      grid(5, rows, [&](double s, double t) { return Eigen::Vector3d(50 + 50 * s, 100 * t, gap); });
  const int offset = static_cast<int>(both.vertices.size());
  both.vertices.insert(both.vertices.end(), right.vertices.begin(), right.vertices.end());
  for (const auto& t : right.triangles)
    both.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return to_obj(both);
}

TEST(ReadStitched, ClosesAGapOnlyWhenAsked) {
  const Health open = read_text(halves(0.05, 8)).health;
  EXPECT_EQ(open.components, 2u);
  EXPECT_THAT(open.warnings, Contains(AllOf(HasSubstr("9 border vertices within 0.1 mm"),
                                            HasSubstr("(50.000, "), HasSubstr("design.stitch_mm"))));
  ReadOptions options{"mm", 'z'};
  options.stitch_mm = 0.06;
  const DesignSurface closed = read_text(halves(0.05, 8), options);
  EXPECT_EQ(closed.health.components, 1u);
  EXPECT_EQ(closed.health.border_loops, 1u);
  EXPECT_EQ(closed.health.vertices, 2 * 6 * 9 - 9u);
  EXPECT_EQ(closed.health.unused_vertices, 0u);
  EXPECT_THAT(closed.health.repairs, Contains(HasSubstr("stitched 9 border vertices to another border, moved "
                                                        "by at most 0.05 mm")));
  options.stitch_mm = 0.04;
  EXPECT_EQ(read_text(halves(0.05, 8), options).health.components, 2u);
  EXPECT_THAT(read_text(halves(0.2, 8)).health.warnings, IsEmpty());
}

TEST(ReadStitched, NeverJoinsTheEndsOfAnEdge) {
  // Edges of 10 mm along the borders, a distance of 12 mm: each vertex joins its opposite and nothing else.
  ReadOptions options{"mm", 'z'};
  options.stitch_mm = 12;
  const Health health = read_text(halves(0.5, 10), options).health;
  EXPECT_EQ(health.components, 1u);
  EXPECT_EQ(health.degenerate_faces, 0u);
  EXPECT_EQ(health.triangles, 200u);
}

TEST(FindStitches, JoinsTheClosestFirst) {
  // Two triangles' corners near each other, a third a little farther: the pairs of least distance win.
  const TriangleMesh mesh(
      {{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 0.3}, {-10, 0, 0}, {0, -10, 0}}, {{0, 1, 2}, {3, 4, 5}}});
  const Stitches s = find_stitches(mesh, 0.5);
  EXPECT_THAT(s.vertex, ElementsAre(0, 1, 2, 0, 4, 5));
  EXPECT_EQ(s.joined, 1u);
  EXPECT_EQ(s.first, 3);
  EXPECT_DOUBLE_EQ(s.largest_move_mm, 0.3);
}

}  // namespace
}  // namespace hotblade::surface
