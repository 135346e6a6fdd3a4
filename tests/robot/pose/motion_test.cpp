#include "robot/pose/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hotblade::robot {
namespace {

TEST(Pose, CanonicalMakesTheLargestComponentPositive) {
  EXPECT_EQ(canonical({-0.5, 0.5, 0.5, 0.5}).w(), 0.5) << "the lowest index on ties";
  EXPECT_EQ(canonical({0.1, -0.9, 0.3, 0.3}).x(), 0.9);
  EXPECT_EQ(canonical({0.1, 0.9, -0.3, 0.3}).z(), 0.3) << "left alone";
}

TEST(Pose, TransformedTurnsThenMoves) {
  const Pose frame{{1, 2, 3}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()))};
  const Pose seen = transformed(frame, {{10, 0, 0}, {1, 0, 0, 0}});
  EXPECT_LT((seen.p - Eigen::Vector3d(1, 12, 3)).norm(), 1e-12);
  EXPECT_LT((seen.q * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST(Interpolate, TakesTheShorterArcWhateverTheSign) {
  const Pose from{{0, 0, 0}, {1, 0, 0, 0}};
  Pose to{{10, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()))};
  const Eigen::Quaterniond half(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()));
  EXPECT_LT(interpolate(from, to, 0.5).q.angularDistance(half), 1e-12);
  to.q.coeffs() = -to.q.coeffs();
  EXPECT_LT(interpolate(from, to, 0.5).q.angularDistance(half), 1e-12);
  EXPECT_DOUBLE_EQ(interpolate(from, to, 0.25).p.x(), 2.5);
}

TEST(PathClock, AStopUsesTheBrakingPathItAnnounced) {
  PathClock clock;
  clock.start_at_full_rate();
  clock.advance(1);
  EXPECT_DOUBLE_EQ(clock.path_s(), 1);
  const double announced = clock.braking_s();
  EXPECT_DOUBLE_EQ(announced, clock.full_braking_s());
  clock.slow_down();
  while (!clock.at_rest()) clock.advance(std::min(0.003, clock.ramp_left_s()));
  EXPECT_NEAR(clock.path_s(), 1 + announced, 1e-12);
  EXPECT_EQ(clock.rate(), 0);
}

TEST(PathClock, TimeToAPlaceIsTheTimeItTakes) {
  PathClock clock;
  clock.speed_up();
  for (const double distance : {1e-9, 1e-4, 0.01, 0.2}) {
    PathClock copy = clock;
    copy.advance(copy.time_to(distance));
    EXPECT_NEAR(copy.path_s(), distance, 1e-12) << "while speeding up";
  }
  clock.start_at_full_rate();
  clock.slow_down();
  PathClock copy = clock;
  copy.advance(copy.time_to(0.1));
  EXPECT_NEAR(copy.path_s(), 0.1, 1e-12) << "while slowing down";
  EXPECT_TRUE(std::isinf(clock.time_to(0.2501))) << "it stops before";
}

TEST(PathClock, AnInstantClockHasNoRamps) {
  PathClock clock(true);
  clock.speed_up();
  EXPECT_EQ(clock.rate(), 1);
  EXPECT_EQ(clock.braking_s(), 0);
  clock.slow_down();
  EXPECT_TRUE(clock.at_rest());
}

}  // namespace
}  // namespace hotblade::robot
