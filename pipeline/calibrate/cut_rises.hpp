// How a cut moves under measured points with the numbers of a cell.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "pipeline/calibrate/estimate.hpp"

namespace hotblade::pipeline {

// The numbers, and then what their blends do to the cut alike to both sides, in standard deviations.
inline constexpr Eigen::Index kUnknowns = 2 * static_cast<Eigen::Index>(kCellErrors);
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

inline constexpr auto kSlowingIndex = static_cast<std::size_t>(CellError::kSlowing);

// Slowing ends at 0, and no band is narrower than the blade.
[[nodiscard]] ErrorVector within_ends(ErrorVector errors, const Program& program);

// The numbers that are asked for, and what a scan says of them in units of what they are expected within.
[[nodiscard]] std::vector<Eigen::Index> asked_of(const ErrorVector& expected);

// The blends of numbers that are doubted independently of each other, each as long as one standard deviation
// of it.
[[nodiscard]] std::vector<ErrorVector> doubted_blends(const ErrorMatrix& told, const ErrorVector& expected);

// By how much the cut rises under each point of a scan with each of the numbers, near some of them. Heights
// above cuts that differ tell it, as heights are what is fitted: vertices that move along the surface would
// not, as normals are right to a hundredth at its borders, and a hundredth of how far numbers slide the cut
// along itself is far more than what their weaker blends raise it by. The cuts differ by blends, each by what
// is doubted of it: a blend that raises the cut at first and then no more is not told by how it starts. What
// a blend raises it by alike to both sides - a band is wider across a blade that is turned either way - stays
// unknown as long as the blend does.
struct Rises {
  ErrorVector at = ErrorVector::Zero();
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  std::vector<Unknowns> of_point;

  Rises(const StripScan& scan, const Eigen::Isometry3d& placed, const ErrorVector& errors,
        const std::vector<ErrorVector>& blends, const ErrorVector& expected);

  void leave_out(std::size_t error);
};

}  // namespace hotblade::pipeline
