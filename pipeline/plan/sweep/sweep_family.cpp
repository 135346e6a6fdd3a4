#include "pipeline/plan/sweep/sweep_family.hpp"

#include <Eigen/LU>

namespace hotblade::pipeline {

namespace {

using Values = Eigen::Matrix<double, 5, 1>;

Values values_at(const SweepFamily& family, double share) {
  const BasisValues basis = SweepBasis(family.count()).at(share);
  Values v = Values::Zero();
  for (int k = 0; k < 4; ++k)
    v += basis.value[static_cast<std::size_t>(k)] * family.coefficients.col(basis.first + k);
  return v;
}

}  // namespace

SweepState SweepFamily::at(double offset_mm) const {
  const Values v = values_at(*this, (offset_mm - first_mm) / (last_mm - first_mm));
  return {v[0], v[1], {v[2], v[3], v[4]}};
}

elastica::MidState SweepFamily::mid_state(double offset_mm, double length_mm) const {
  const SweepState s = at(offset_mm);
  return {x_mm, s.y, s.theta, s.bend.kappa, s.bend.tension1, s.bend.tension2, length_mm};
}

SweepFamily with_coefficients(const SweepFamily& family, int count) {
  const SweepBasis basis(count);
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(count, count);
  Eigen::Matrix<double, Eigen::Dynamic, 5> values(count, 5);
  for (int i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / (count - 1);
    const BasisValues at = basis.at(share);
    for (int k = 0; k < 4; ++k) weights(i, at.first + k) = at.value[static_cast<std::size_t>(k)];
    values.row(i) = values_at(family, share).transpose();
  }
  SweepFamily other = family;
  other.coefficients = weights.partialPivLu().solve(values).transpose();
  return other;
}

}  // namespace hotblade::pipeline
