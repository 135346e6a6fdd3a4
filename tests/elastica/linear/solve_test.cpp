#include "elastica/linear/solve.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace hotblade::elastica {
namespace {

TEST(SolveSymmetric, FindsWhatTheMatrixTakesToTheRightSideAlsoWithNegativeDirections) {
  for (int seed = 0; seed < 100; ++seed) {
    std::srand(static_cast<unsigned>(seed));
    Eigen::Matrix4d a = Eigen::Matrix4d::Random();
    a = (a + a.transpose()).eval() +
        6 * Eigen::Vector4d(1, -1, 1, seed % 2 ? 1 : -1).asDiagonal().toDenseMatrix();
    const Eigen::Vector4d x = Eigen::Vector4d::Random();
    EXPECT_LT((solve_symmetric(a, a * x) - x).norm(), 1e-13);
  }
}

TEST(ShortestSolution, LeavesWhatIsSquareToAllColumns) {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Random(9, 3);
  const Eigen::VectorXd b = Eigen::VectorXd::Random(9);
  const Eigen::VectorXd x = shortest_solution(a, b);
  EXPECT_LT((a.transpose() * (a * x - b)).norm(), 1e-14 * 9);
}

TEST(ShortestSolution, TakesNothingOfADirectionThatTheMatrixDoesNotSee) {
  const Eigen::Vector2d u(0.6, 0.8);
  const Eigen::VectorXd x = shortest_solution(3 * u * u.transpose(), 6 * u);
  EXPECT_LT((x - 2 * u).norm(), 1e-15);
  EXPECT_EQ(shortest_solution(Eigen::Matrix2d::Zero(), Eigen::Vector2d::Zero()).norm(), 0);
}

}  // namespace
}  // namespace hotblade::elastica
