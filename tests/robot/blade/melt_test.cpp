#include "robot/blade/melt.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "robot/blade/blade.hpp"

namespace hotblade::robot {
namespace {

TEST(Melt, HasThePairsAndHoldsTheirEnds) {
  const Melt melt{{{1, 2.6}, {3, 1.6}, {7, 1.0}}, 0, 0};
  EXPECT_TRUE(melt.by_speed());
  EXPECT_DOUBLE_EQ(melt.band_mm(1), 2.6);
  EXPECT_DOUBLE_EQ(melt.band_mm(3), 1.6);
  EXPECT_DOUBLE_EQ(melt.band_mm(7), 1.0);
  EXPECT_DOUBLE_EQ(melt.band_mm(0), 2.6);
  EXPECT_DOUBLE_EQ(melt.band_mm(20), 1.0);
  double before = melt.band_mm(0.5);
  for (int i = 1; i < 1000; ++i) {
    const double band = melt.band_mm(0.5 + 0.008 * i);
    EXPECT_LE(band, before);
    before = band;
  }
}

TEST(Melt, OfTwoPairsIsTheBalanceOfHeat) {
  const Melt model{{}, 12, 5}, pairs{{{1, 12.0 / 6}, {15, 12.0 / 20}}, 0, 0};
  for (const double speed : {1.0, 2.5, 4.0, 7.0, 11.0, 15.0})
    EXPECT_NEAR(pairs.band_mm(speed), model.band_mm(speed), 1e-14);
  EXPECT_DOUBLE_EQ(model.band_mm(0), 12.0 / 5);
}

TEST(Melt, WithoutNumbersIsTheKerf) {
  EXPECT_FALSE(Melt{}.by_speed());
  EXPECT_THROW((void)Melt{}.band_mm(7), std::logic_error);
  Blade blade;
  blade.kerf_mm = 1.25;
  EXPECT_EQ(blade.band_mm(0.1), 1.25);
  blade.melt = {{{1, 2.6}, {7, 1.0}}, 0, 0};
  EXPECT_EQ(blade.band_mm(7), 1.0);
}

}  // namespace
}  // namespace hotblade::robot
