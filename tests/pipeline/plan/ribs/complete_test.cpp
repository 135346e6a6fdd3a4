#include "pipeline/plan/ribs/complete.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace hotblade::pipeline {
namespace {

using Eigen::Vector2d;
using Curve = std::function<Vector2d(double)>;  // by arc length

RibTarget rib_of(double offset_mm, const Curve& curve, double from, double to, int pieces) {
  RibTarget rib;
  rib.offset_mm = offset_mm;
  for (int i = 0; i <= pieces; ++i) {
    rib.points.push_back(curve(from + (to - from) * i / pieces));
    rib.s.push_back(i == 0 ? 0
                           : rib.s.back() + (rib.points.back() - rib.points[rib.points.size() - 2]).norm());
  }
  return rib;
}

Curve circle(double radius) {
  return [radius](double s) -> Vector2d {
    return radius * Vector2d(std::sin(s / radius), std::cos(s / radius));
  };
}

// Sections of a surface whose border is a disc of 400 mm, 20 mm apart, the outermost a hair inside.
std::vector<RibTarget> disc_of(const std::function<Curve(double)>& section) {
  constexpr double kRadius = 400;
  std::vector<RibTarget> ribs;
  for (int k = -20; k <= 20; ++k) {
    const double offset = std::clamp(20.0 * k, -kRadius + 0.01, kRadius - 0.01);
    const double half = std::sqrt(kRadius * kRadius - offset * offset);
    ribs.push_back(rib_of(offset, section(offset), -half, half, 60));
  }
  return ribs;
}

TEST(CompleteRibs, LeavesSectionsOfSimilarWidthAsTheyAre) {
  std::vector<RibTarget> ribs;
  for (int k = 0; k < 10; ++k) ribs.push_back(rib_of(20 * k, circle(500), 50 * (k % 3), 400, 40));
  EXPECT_FALSE(complete_ribs(ribs));
}

TEST(CompleteRibs, NeverMovesAPointOfTheDesignsOwnPartAndMakesAllRibsEquallyWide) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(0, 1);
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<RibTarget> ribs;
    const double radius = 200 + 2000 * u(random), twist = u(random) - 0.5, steps = 2 + 30 * u(random);
    for (double k = 0; k <= steps; ++k) {
      const double from = -300 * u(random), to = 300 * u(random) + 1e-3;
      const Curve arc = circle(radius + 20 * k * twist);
      ribs.push_back(rib_of(15 * k + u(random), arc, from, to, 1 + static_cast<int>(40 * u(random))));
    }
    const auto whole = complete_ribs(ribs);
    if (!whole) continue;
    ASSERT_EQ(whole->size(), ribs.size());
    for (std::size_t k = 0; k < ribs.size(); ++k) {
      const RibTarget &own = ribs[k], &rib = (*whole)[k];
      ASSERT_TRUE(rib.own);
      const auto first = std::find(rib.points.begin(), rib.points.end(), own.points.front());
      ASSERT_LE(own.points.size(), static_cast<std::size_t>(rib.points.end() - first));
      EXPECT_TRUE(std::equal(own.points.begin(), own.points.end(), first));
      EXPECT_NEAR(rib.own->last - rib.own->first, own.s.back(), 1e-9);
      EXPECT_NEAR(rib.s[static_cast<std::size_t>(first - rib.points.begin())], rib.own->first, 1e-9);
      EXPECT_NEAR(rib.s.back(), whole->front().s.back(), 1e-9);
      for (std::size_t i = 1; i < rib.points.size(); ++i)
        EXPECT_NEAR(rib.s[i] - rib.s[i - 1], (rib.points[i] - rib.points[i - 1]).norm(), 1e-9);
    }
  }
}

TEST(CompleteRibs, GoesOnAlongTheCircleThatADiscIsCutFrom) {
  for (const double radius : {600.0, 1500.0, 1e5}) {
    const auto whole = complete_ribs(disc_of([&](double) { return circle(radius); }));
    ASSERT_TRUE(whole);
    for (const RibTarget& rib : *whole) {
      EXPECT_NEAR(rib.s.back(), 800, 0.5);
      for (std::size_t i = 0; i < rib.points.size(); ++i) {
        // The direction at the border within a milliradian; past it the plate's tension lets a curvature
        // fade over four windows, which is little of how far the circle bends away from its tangent.
        const double away = std::max({0.0, rib.own->first - rib.s[i], rib.s[i] - rib.own->last});
        EXPECT_NEAR(rib.points[i].norm(), radius, 1e-3 * away + 0.02 * away * away / radius + 1e-6) << radius;
      }
    }
  }
}

// Straight lines that turn along the sweep: z = x y / 2000.
TEST(CompleteRibs, GoesOnAlongTheLinesOfAHyparWhereItsBorderIsADisc) {
  const auto line = [](double offset) -> Curve {
    const double slope = offset / 2000, length = std::sqrt(1 + slope * slope);
    return [=](double s) -> Vector2d { return Vector2d(s / length, slope * s / length); };
  };
  const auto whole = complete_ribs(disc_of(line));
  ASSERT_TRUE(whole);
  for (const RibTarget& rib : *whole) {
    for (const Vector2d& q : rib.points) EXPECT_NEAR(q.y(), rib.offset_mm / 2000 * q.x(), 0.5);
  }
}

// A wave that is the same in all sections: the shorter ones follow the longer ones beside them.
TEST(CompleteRibs, FollowsWhatTheSectionsBesideItDo) {
  constexpr double kHeight = 10, kNumber = 2 * 3.14159265358979 / 600;
  std::vector<RibTarget> ribs;
  for (int k = 0; k <= 20; ++k) {
    RibTarget rib;
    rib.offset_mm = 20 * k;
    const double reach = 400 - 16 * k;
    for (int i = 0; i <= 200; ++i) {
      const double x = -400 + (400 + reach) * i / 200;
      rib.points.emplace_back(x, kHeight * std::sin(kNumber * x));
      rib.s.push_back(i == 0 ? 0
                             : rib.s.back() + (rib.points.back() - rib.points[rib.points.size() - 2]).norm());
    }
    ribs.push_back(std::move(rib));
  }
  const auto whole = complete_ribs(ribs);
  ASSERT_TRUE(whole);
  // 40 mm past its border a rib has design within 80 mm of the sweep, a seventh of the wave's length.
  for (std::size_t k = 0; k < ribs.size(); ++k) {
    const double end = ribs[k].points.back().x();
    for (const Vector2d& q : (*whole)[k].points) {
      if (q.x() > end + 40) continue;
      EXPECT_NEAR(q.y(), kHeight * std::sin(kNumber * q.x()), 0.15 * kHeight) << k << " at " << q.x() - end;
    }
  }
}

TEST(CompleteRibs, TurnsNoFurtherThanARadianInTheWaste) {
  const auto whole = complete_ribs(disc_of([](double) { return circle(130); }));
  ASSERT_TRUE(whole);
  for (const RibTarget& rib : *whole) {
    double turned = 0;
    for (std::size_t i = 2; i < rib.points.size(); ++i) {
      if (rib.s[i - 1] < rib.own->last) continue;
      const Vector2d a = rib.points[i - 1] - rib.points[i - 2], b = rib.points[i] - rib.points[i - 1];
      turned += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
    EXPECT_LT(std::abs(turned), 1.2);
  }
}

TEST(AlignedStarts, GiveNeighbouringPointsTheSameCoordinate) {
  std::vector<RibTarget> ribs;
  const std::vector<double> from{-100, -250, -30, 10, 60}, to{300, 320, 200, 40, 61};
  for (std::size_t k = 0; k < from.size(); ++k)
    ribs.push_back(rib_of(20.0 * static_cast<double>(k), circle(400), from[k], to[k], 400));
  const std::vector<double> starts = aligned_starts(ribs);
  EXPECT_EQ(starts[1], 0);
  for (std::size_t k = 0; k < from.size(); ++k) EXPECT_NEAR(starts[k], from[k] - from[1], 0.05);
}

}  // namespace
}  // namespace hotblade::pipeline
