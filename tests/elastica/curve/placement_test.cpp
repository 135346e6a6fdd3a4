#include "elastica/curve/placement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace hotblade::elastica {
namespace {

class Placement : public ::testing::Test {
 protected:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Elastica any_curve() {
    const double length = between(1, 900), force = 30 / (length * length);
    return {between(-500, 500),     between(-500, 500),     between(-7, 7), between(-4, 4) / length,
            between(-force, force), between(-force, force), length};
  }
  Eigen::Isometry2d any_move() {
    Eigen::Isometry2d move = Eigen::Isometry2d::Identity();
    move.translate(Eigen::Vector2d(between(-800, 800), between(-800, 800)));
    move.rotate(between(-std::numbers::pi, std::numbers::pi));
    return move;
  }

 private:
  std::mt19937_64 random_{5};
};

TEST_F(Placement, MovesEveryPointOfTheCurve) {
  for (int i = 0; i < 300; ++i) {
    const Elastica e = any_curve();
    const Eigen::Isometry2d move = any_move();
    const Elastica moved = transformed(e, move);
    for (const double share : {0.0, 0.3, 0.7, 1.0}) {
      const CurvePoint was = point_at(e, share * e.length), is = point_at(moved, share * e.length);
      EXPECT_LT((is.position() - move * was.position()).norm(), 1e-9 * (1500 + e.length));
      EXPECT_LT((is.tangent() - move.linear() * was.tangent()).norm(), 1e-9);
      EXPECT_NEAR(is.kappa, was.kappa, 1e-10 / e.length * 40);
    }
  }
}

TEST_F(Placement, GoesBackByTheInverseMove) {
  for (int i = 0; i < 300; ++i) {
    const Elastica e = any_curve();
    const Eigen::Isometry2d move = any_move();
    const Elastica back = transformed(transformed(e, move), move.inverse());
    EXPECT_NEAR(back.x, e.x, 1e-9);
    EXPECT_NEAR(back.y, e.y, 1e-9);
    EXPECT_NEAR(std::remainder(back.theta - e.theta, 2 * std::numbers::pi), 0, 1e-12);
    EXPECT_EQ(back.kappa, e.kappa);
    const double force = std::hypot(e.lambda1, e.lambda2);
    EXPECT_NEAR(back.lambda1, e.lambda1, 1e-14 * force);
    EXPECT_NEAR(back.lambda2, e.lambda2, 1e-14 * force);
    EXPECT_EQ(back.length, e.length);
  }
}

TEST_F(Placement, AtTheOriginIsTheMoveOfTheStartThere) {
  for (int i = 0; i < 300; ++i) {
    const Elastica e = any_curve(), placed = at_origin(e);
    Eigen::Isometry2d to_place = Eigen::Isometry2d::Identity();
    to_place.translate(Eigen::Vector2d(e.x, e.y)).rotate(e.theta);
    const Elastica again = transformed(placed, to_place);
    EXPECT_EQ(placed.x, 0);
    EXPECT_EQ(placed.y, 0);
    EXPECT_EQ(placed.theta, 0);
    const double force = std::hypot(e.lambda1, e.lambda2);
    EXPECT_NEAR(again.lambda1, e.lambda1, 1e-14 * force);
    EXPECT_NEAR(again.lambda2, e.lambda2, 1e-14 * force);
    EXPECT_EQ(again.x, e.x);
    EXPECT_EQ(again.y, e.y);
  }
}

// The energy's force does not know of axes: its part along the tangent turns with nothing.
TEST_F(Placement, KeepsTheForceAlongTheTangent) {
  for (int i = 0; i < 300; ++i) {
    const Elastica e = any_curve(), moved = transformed(e, any_move());
    const Eigen::Vector2d was = force_along(e, e.theta), is = force_along(moved, moved.theta);
    EXPECT_LT((is - was).norm(), 1e-13 * was.norm());
  }
}

}  // namespace
}  // namespace hotblade::elastica
