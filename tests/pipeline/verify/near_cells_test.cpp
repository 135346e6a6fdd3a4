#include "pipeline/verify/near_cells.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <stdexcept>

namespace hotblade::pipeline {
namespace {

TEST(NearCells, HoldEveryPointWithinTheDistanceAndNoneFarBeyond) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-500, 500);
  const auto point = [&] { return Eigen::Vector3d(u(random), u(random), u(random)); };
  std::vector<Eigen::Vector3d> points(60);
  for (Eigen::Vector3d& p : points) p = point();
  const double near = 40;
  const NearCells cells(points, near);
  int held = 0, beyond = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d q = point();
    double distance = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& p : points) distance = std::min(distance, (p - q).norm());
    if (distance <= near) {
      EXPECT_TRUE(cells.holds(q));
      ++held;
    } else if (distance > 2 * std::sqrt(3.0) * near) {
      EXPECT_FALSE(cells.holds(q));
      ++beyond;
    }
  }
  EXPECT_GT(held, 50);
  EXPECT_GT(beyond, 50);
}

TEST(NearCells, AnswerManyAsOneByOne) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> step(0, 3);
  std::vector<Eigen::Vector3d> points(40), path(20000);
  std::uniform_real_distribution<double> u(-200, 200);
  for (Eigen::Vector3d& p : points) p = {u(random), u(random), u(random)};
  const NearCells cells(points, 15);
  Eigen::Vector3d at(0, 0, 0);  // a walk: most points share the cell of the one before
  for (Eigen::Vector3d& p : path) p = at += Eigen::Vector3d(step(random), step(random), step(random));
  std::vector<char> held(path.size());
  cells.hold(path, held);
  std::size_t near = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ(held[i] != 0, cells.holds(path[i]));
    near += held[i] != 0 ? 1 : 0;
  }
  EXPECT_GT(near, 100u);
  EXPECT_LT(near, path.size() - 100);
  EXPECT_THROW(cells.hold(path, std::span(held).first(3)), std::logic_error);
}

TEST(NearCells, RefuseWhatHasNoPlace) {
  const std::vector<Eigen::Vector3d> lost{{std::numeric_limits<double>::quiet_NaN(), 0, 0}};
  EXPECT_THROW(NearCells(lost, 1), std::logic_error);
  EXPECT_THROW(NearCells({}, 0), std::logic_error);
}

}  // namespace
}  // namespace hotblade::pipeline
