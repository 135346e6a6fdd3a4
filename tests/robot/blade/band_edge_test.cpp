#include "robot/blade/band_edge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hotblade::robot {
namespace {

TEST(OverWidth, IsTheFarthestOfAllPlacesOfTheWidth) {
  constexpr double kWidth = 8;
  constexpr int kPlaces = 4000;
  for (const double bend : {-0.3, -0.02, -0.001, 0.0, 0.001, 0.02, 0.12}) {
    for (const double along : {-0.9, -0.3, -0.05, 0.0, 0.01, 0.4, 1.0}) {
      double farthest = 0;
      for (int i = -kPlaces; i <= kPlaces; ++i) {
        const double t = 0.5 * kWidth * i / kPlaces;
        farthest = std::max(farthest, along * t + 0.5 * bend * t * t);
      }
      EXPECT_NEAR(over_width_mm(along, bend, kWidth), farthest, 1e-5) << along << " " << bend;
    }
  }
}

TEST(OverWidth, GoesIntoNoHollowThatIsNarrower) {
  EXPECT_EQ(over_width_mm(0, 10, 8), over_width_mm(0, 1.0 / 8, 8));
  EXPECT_EQ(over_width_mm(0.5, -1e9, 8), 0.5 * 0.25 / 1e9);
  EXPECT_EQ(over_width_mm(0.5, 0.1, 0), 0);
}

}  // namespace
}  // namespace hotblade::robot
