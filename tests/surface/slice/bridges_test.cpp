#include "surface/slice/bridges.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/surface/meshes.hpp"

namespace hotblade::surface {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A shallow arch, 400 mm along x and 300 along y, in cells of 10 mm.
Vector3d arch(double s, double t) {
  return {400 * s, 300 * t, 60 * std::sin(std::numbers::pi * s)};
}

// Sections along x, in that sense; their offsets run against y.
RibGraph along_x(const TriangleSoup& mesh) {
  SliceOptions options;
  options.normal = -Vector3d::UnitY();
  return slice(from_mesh(mesh), options);
}

const SectionPiece& piece(const RibGraph& graph, const RibRef& ref) {
  return graph.sections[static_cast<std::size_t>(ref.section)].pieces[static_cast<std::size_t>(ref.piece)];
}

bool in(int i, int low, int high) {
  return low <= i && i < high;
}

TEST(Bridges, AWindowIsSpannedWithTheChainsBeforeBehindAndBesideIt) {
  const auto graph =
      along_x(grid(40, 30, arch, [](int i, int j) { return !(in(i, 15, 25) && in(j, 10, 20)); }));
  ASSERT_THAT(graph.chains, SizeIs(4));
  ASSERT_THAT(graph.bridges, SizeIs(1));
  const Bridge& bridge = graph.bridges[0];
  EXPECT_THAT(bridge.chains, ElementsAre(0, 1, 2, 3));
  ASSERT_EQ(bridge.ribs.size(), graph.sections.size());
  for (std::size_t k = 0; k < bridge.ribs.size(); ++k) {
    const double y = 150 - graph.sections[k].offset_mm;  // measured from the middle
    const bool through = 100 < y && y < 200;
    ASSERT_EQ(bridge.ribs[k].size(), through ? 2u : 1u) << "y " << y;
    EXPECT_NEAR(piece(graph, bridge.ribs[k].front()).points.front().p.x(), 0, 1e-9);
    EXPECT_NEAR(piece(graph, bridge.ribs[k].back()).points.back().p.x(), 400, 1e-9);
    if (!through) continue;
    EXPECT_NEAR(piece(graph, bridge.ribs[k][0]).points.back().p.x(), 150, 1e-9);
    EXPECT_NEAR(piece(graph, bridge.ribs[k][1]).points.front().p.x(), 250, 1e-9);
  }
}

TEST(Bridges, ANotchAndTwoWindowsInARowAreSpannedTogether) {
  const auto graph = along_x(grid(40, 30, arch, [](int i, int j) {
    const bool windows = (in(i, 8, 14) || in(i, 26, 32)) && in(j, 12, 20);
    return !windows && !(in(i, 18, 22) && j >= 24);
  }));
  ASSERT_THAT(graph.bridges, SizeIs(1));
  EXPECT_EQ(graph.bridges[0].chains.size(), graph.chains.size());
  std::size_t most = 0;
  for (const auto& rib : graph.bridges[0].ribs) most = std::max(most, rib.size());
  EXPECT_EQ(most, 3u);
}

TEST(Bridges, ArmsOfDifferentLengthAreNone) {
  const auto graph =
      along_x(grid(40, 30, arch, [](int i, int j) { return j < 15 || i < 15 || (i >= 25 && j < 22); }));
  ASSERT_THAT(graph.chains, SizeIs(3));
  EXPECT_THAT(graph.bridges, IsEmpty());
}

// From y = 150 on the right half rolls up about the middle, by 150 degrees in the end.
TEST(Bridges, ArmsThatTurnAwayFromEachOtherAreNone) {
  const auto rolling = [](double s, double t) -> Vector3d {
    const double x = 400 * s - 200, y = 600 * t, angle = x > 0 ? std::max(0.0, y - 150) / 450 * 2.6 : 0;
    return {x * std::cos(angle), y, x * std::sin(angle)};
  };
  const auto slit = [](int i, int j) { return j < 15 || !in(i, 18, 22); };
  const RibGraph graph = along_x(grid(40, 60, rolling, slit));
  ASSERT_THAT(graph.chains, SizeIs(3));
  EXPECT_THAT(graph.bridges, IsEmpty());
  const auto flat = [](double s, double t) -> Vector3d { return {400 * s, 600 * t, 0}; };
  EXPECT_THAT(along_x(grid(40, 60, flat, slit)).bridges, SizeIs(1));
}

TEST(Bridges, AnUnbrokenPanelATubeAndTwoPanelsSideBySideHaveNone) {
  EXPECT_THAT(along_x(grid(40, 30, arch)).bridges, IsEmpty());
  const auto tube = [](double s, double t) -> Vector3d {
    const double angle = 2 * std::numbers::pi * s;
    return {100 * std::cos(angle), 300 * t, 100 * std::sin(angle)};
  };
  EXPECT_THAT(along_x(grid(
                          40, 30, tube, [](int, int) { return true; }, true))
                  .bridges,
              IsEmpty());
  EXPECT_THAT(along_x(grid(40, 30, arch, [](int i, int) { return !in(i, 18, 22); })).bridges, IsEmpty());
}

}  // namespace
}  // namespace hotblade::surface
