// What a blade's free parts do in the stock, against samples ten times as dense.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "elastica/curve/elastica.hpp"
#include "pipeline/plan/motion/blade.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;

constexpr int kFinely = 500;

std::vector<Vector2d> finely(const elastica::Elastica& blade, double s0, double s1) {
  std::vector<Vector2d> points;
  for (int k = 0; k <= kFinely; ++k)
    points.push_back(elastica::point_at(blade, s0 + (s1 - s0) * k / kFinely).position());
  return points;
}

// How deep q lies on the right of the part, beside a place inside it; 0 where its ends are nearest.
double depth_behind_finely(const Vector2d& q, const std::vector<Vector2d>& part) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < part.size(); ++k) {
    const double away = (q - part[k]).norm();
    if (away < least) {
      least = away;
      nearest = k;
    }
  }
  if (nearest == 0 || nearest + 1 == part.size()) return 0;
  const Vector2d along = part[nearest + 1] - part[nearest - 1], away = q - part[nearest];
  return along.x() * away.y() - along.y() * away.x() < 0 ? least : 0;
}

TEST(FreeParts, AreAsDeepInTheKeptSideAsDenseSamplesSay) {
  const Block everywhere{{{-5000, -5000, -5000}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()},
                         {10000, 10000, 10000}};
  std::mt19937 random(20261128);
  std::uniform_real_distribution<double> share(-1, 1), from(0.05, 0.45), turn(-3, 3);
  int nearly_straight = 0, deep = 0;
  for (int n = 0; n < 400; ++n) {
    constexpr double kWholeMm = 1000;
    // From nearly straight ones to those that wind about themselves.
    const double bend = std::pow(10, 1.5 * share(random));
    const elastica::Elastica blade{0,
                                   0,
                                   turn(random),
                                   bend * share(random) / kWholeMm,
                                   bend * share(random) / (kWholeMm * kWholeMm),
                                   bend * share(random) / (kWholeMm * kWholeMm),
                                   kWholeMm};
    const double s0 = kWholeMm * from(random), s1 = kWholeMm * (1 - from(random));
    const FreeParts free = examine_free_parts(blade, s0, s1, everywhere);
    const std::vector<Vector2d> part = finely(blade, s0, s1);
    double depth_mm = 0;
    for (const auto& [first, last] : {std::pair(0.0, s0), std::pair(s1, kWholeMm)}) {
      for (const Vector2d& q : finely(blade, first, last))
        depth_mm = std::max(depth_mm, depth_behind_finely(q, part));
    }
    // A step of the blade's own samples, along which a free part may go deeper; a deep one crosses.
    constexpr double kStepMm = kWholeMm / (kBladeSamples - 1);
    EXPECT_NEAR(free.depth_mm, depth_mm, kStepMm) << n;
    if (elastica::turns_at_most(blade, kWholeMm) < std::numbers::pi / 2) {
      ++nearly_straight;
      EXPECT_EQ(depth_mm, 0) << n;
    }
    if (depth_mm > kStepMm) ++deep;
  }
  EXPECT_GT(nearly_straight, 100);
  EXPECT_GT(deep, 20);
}

}  // namespace
}  // namespace hotblade::pipeline
