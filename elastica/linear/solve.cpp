#include "elastica/linear/solve.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace hotblade::elastica {

Eigen::Vector4d solve_symmetric(const Eigen::Matrix4d& a, const Eigen::Vector4d& b) {
  return a.ldlt().solve(b);
}

Eigen::VectorXd shortest_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

}  // namespace hotblade::elastica
