// Linear systems of a few unknowns. Eigen's decompositions take seconds to compile for every size and in
// every unit that names one: those that several rooms need are compiled here, once.
#pragma once

#include <Eigen/Core>

namespace hotblade::elastica {

// Returns x with a x = b for a symmetric matrix without a direction of zero (LDL^T with pivots).
[[nodiscard]] Eigen::Vector4d solve_symmetric(const Eigen::Matrix4d& a, const Eigen::Vector4d& b);

// Returns the shortest of all x that bring a x nearest to b; `a` may have any shape and any rank, which is
// counted to rounding (complete orthogonal decomposition).
[[nodiscard]] Eigen::VectorXd shortest_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

}  // namespace hotblade::elastica
