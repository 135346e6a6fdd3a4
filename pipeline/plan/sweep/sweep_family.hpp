// One family of elastica over a sweep: what a strip's blade does, before its length is cut.
#pragma once

#include <Eigen/Core>

#include "elastica/fit/fit.hpp"
#include "pipeline/plan/sweep/sweep_basis.hpp"
#include "pipeline/plan/sweep/sweep_curve.hpp"

namespace hotblade::pipeline {

// The blade's middle and what bends it there, on a sweep's axes; the middle's x is common to the family,
// which keeps its curves from sliding along themselves.
struct SweepState {
  double y = 0, theta = 0;
  Bend bend;
};

struct SweepFamily {
  double first_mm = 0, last_mm = 0;  // along the sweep
  double x_mm = 0;                   // of all middles
  // Spline coefficients over the sweep (SweepBasis), a column each: y, theta, kappa, tension1, tension2.
  Eigen::Matrix<double, 5, Eigen::Dynamic> coefficients;

  [[nodiscard]] int count() const { return static_cast<int>(coefficients.cols()); }
  [[nodiscard]] SweepState at(double offset_mm) const;  // before the first and behind the last: as there
  [[nodiscard]] elastica::MidState mid_state(double offset_mm, double length_mm) const;
};

// The same family, as nearly as it can be, with another number of coefficients: equal at as many evenly
// spaced places.
[[nodiscard]] SweepFamily with_coefficients(const SweepFamily& family, int count);

}  // namespace hotblade::pipeline
