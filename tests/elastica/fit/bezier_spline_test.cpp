#include "elastica/fit/bezier_spline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "elastica/bezier/curve_distance.hpp"

namespace hotblade::elastica {
namespace {

Elastica random_elastica(std::mt19937& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  return {300 * u(random),  300 * u(random),  3 * u(random),        0.012 * u(random),
          5e-5 * u(random), 5e-5 * u(random), 300 + 200 * u(random)};
}

TEST(BezierSpline, ComesWithinTheDistanceAndJoinsWithItsDerivatives) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 200; ++trial) {
    const Elastica e = random_elastica(random);
    const std::vector<Bezier> pieces = bezier_spline(e, 0.1);
    const double n = static_cast<double>(pieces.size()), length = e.length / n;
    ASSERT_LT(pieces.size(), static_cast<std::size_t>(kMostSplinePieces));
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const double from = static_cast<double>(i) * length;
      EXPECT_LE(hausdorff(pieces[i], segment(e, from, from + length), 1e-4).lower, 0.1);
      EXPECT_LE((pieces[i][0] - point_at(e, from).position()).norm(), 1e-9);
      if (i == 0) continue;
      EXPECT_EQ(pieces[i][0], pieces[i - 1][3]);
      EXPECT_LE((pieces[i][1] - pieces[i][0] - (pieces[i - 1][3] - pieces[i - 1][2])).norm(), 1e-9);
    }
  }
}

TEST(BezierSpline, HalfTheNumberWouldNotDo) {
  std::mt19937 random(12);
  int several = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Elastica e = random_elastica(random);
    const std::size_t count = bezier_spline(e, 0.05).size();
    if (count == 1) continue;
    ++several;
    // The one before is the answer to a larger distance; it has no more pieces than half.
    double distance = 0.05;
    while (bezier_spline(e, distance).size() == count) distance *= 1.1;
    EXPECT_GT(distance, 0.05);
    EXPECT_LE(bezier_spline(e, distance).size(), count / 2);
  }
  EXPECT_GT(several, 50);
}

TEST(BezierSpline, OfAStraightBladeIsOneCubic) {
  EXPECT_EQ(bezier_spline({0, 0, 0.3, 0, 0, 0, 500}, 1e-6).size(), 1u);
}

TEST(BezierSpline, NeedsADistance) {
  EXPECT_THROW((void)bezier_spline({0, 0, 0, 0.001, 0, 0, 500}, 0), std::logic_error);
}

}  // namespace
}  // namespace hotblade::elastica
