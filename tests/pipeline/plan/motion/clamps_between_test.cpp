#include "pipeline/plan/motion/clamps_between.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "pipeline/plan/ribs/strip_plan.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

constexpr double kLengthMm = 600, kShare = 0.4;

// Blades that turn and bend on their way, in parallel planes or about an axis, over a block.
struct BladesAt {
  std::vector<RibFit> ribs;
  RibAxes axes;
  Block block;
};

BladesAt random_blades(std::mt19937_64& random, bool fan) {
  const auto in = [&](double from, double to) { return std::uniform_real_distribution(from, to)(random); };
  constexpr double kRadius = 500;
  BladesAt at;
  at.axes.planes =
      fan ? surface::PlaneFamily::fan({Vector3d::Zero(), Vector3d::UnitZ()}, Vector3d::UnitX(), kRadius)
          : surface::PlaneFamily::parallel(Vector3d::UnitY());
  at.axes.sweep = at.axes.planes.normal(0);
  at.axes.x = fan ? Vector3d::UnitZ() : Vector3d::UnitX();
  at.axes.y = fan ? Vector3d::UnitX() : Vector3d::UnitZ();
  const double extent = in(200, 800);
  for (int i = 0; i < 5; ++i) {
    RibFit& rib = at.ribs.emplace_back();
    rib.offset_mm = extent * (i / 4.0 - 0.5);
    elastica::Elastica& e = rib.elastica;
    e = {-150, 480 + in(-50, 50), in(-0.5, 0.5), in(-2e-3, 2e-3), in(-1e-6, 1e-6), in(-1e-6, 1e-6), 300};
    if (!fan) e.y -= 480;
  }
  at.block.size_mm = {in(300, 420), in(150, 260), in(200, 600)};
  const double z = fan ? 480 : 0;
  at.block.frame.x = at.axes.plane(0).x;
  at.block.frame.y = at.axes.plane(0).y;
  at.block.frame.origin = at.axes.plane(0).point(-0.5 * at.block.size_mm.x(), z - 0.5 * at.block.size_mm.y());
  at.block.frame.origin -= 0.5 * at.block.size_mm.z() * at.block.frame.normal();
  return at;
}

// The least of both clamps' clearances at so many places from the first rib to the last.
double least_at(const BladesAt& at, int places) {
  const RibSpline spline(at.ribs);
  const double from = at.ribs.front().offset_mm, to = at.ribs.back().offset_mm;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= places; ++i) {
    const double offset = from + (to - from) * i / places;
    const Frame plane = at.axes.plane(offset);
    const elastica::Elastica blade = extended(from_mid_state(spline.mid_at(offset)), kLengthMm, kShare);
    for (const double s : {0.0, kLengthMm}) {
      const elastica::CurvePoint end = elastica::point_at(blade, s);
      least = std::min(least, at.block.distance_mm(plane.point(end.x, end.y)));
    }
  }
  return least;
}

TEST(ClampsBetween, AreClearAllTheWayWhereTheyAreFoundClear) {
  std::mt19937_64 random(11);
  int missed_by_quarters = 0, clear = 0, near = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const BladesAt at = random_blades(random, trial % 2 == 0);
    const double least = least_at(at, 2000), quarters = least_at(at, 16);
    ASSERT_GT(least, 0) << trial;
    const ClampsBetween between(at.ribs, at.axes, at.block);
    // Whatever is asked for. Half a mm may hide in ways of 1 mm.
    for (const double enough :
         {0.5 * least, least - 0.5, least + 0.01, 0.5 * (least + quarters) + 0.01, quarters + 5}) {
      const ClampsBetween::Clearance found = between.least(kLengthMm, kShare, enough);
      EXPECT_GE(found.mm, least - 1e-3) << trial;
      if (found.mm >= enough) {
        EXPECT_GE(least, enough - 0.5) << trial;
        ++clear;
      } else {
        EXPECT_LE(least, enough) << trial;
        ++near;
      }
    }
    if (quarters > least + 2) ++missed_by_quarters;
  }
  EXPECT_GE(missed_by_quarters, 5);  // else quarters would do
  EXPECT_GE(clear, 300);
  EXPECT_GE(near, 300);
}

TEST(ClampsBetween, NameTheRibBefore) {
  std::mt19937_64 random(5);
  BladesAt at = random_blades(random, false);
  // Only on its way from the third rib to the fourth does the blade come down to the block's end.
  for (RibFit& rib : at.ribs) rib.elastica = {-150, 400, 0, 0, 0, 0, 300};
  for (int i = 0; i < 5; ++i) at.ribs[static_cast<std::size_t>(i)].offset_mm = 200 * (i - 2);
  at.block.size_mm = {900, 100, 10};
  at.block.frame.origin = at.axes.plane(0.5 * (at.ribs[2].offset_mm + at.ribs[3].offset_mm))
                              .point(-0.5 * at.block.size_mm.x(), 390 - at.block.size_mm.y());
  const ClampsBetween::Clearance found =
      ClampsBetween(at.ribs, at.axes, at.block).least(kLengthMm, kShare, 80);
  EXPECT_LT(found.mm, 80);
  EXPECT_EQ(found.after, 2);
}

}  // namespace
}  // namespace hotblade::pipeline
