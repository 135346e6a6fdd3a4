// A strip between its ribs: the states at the ribs' middles interpolated over the sweep by a cubic spline. An
// interpolated state is again an exact elastica.
#pragma once

#include <span>
#include <unsupported/Eigen/Splines>

#include "pipeline/plan/ribs/rib_fit.hpp"

namespace hotblade::pipeline {

class RibSpline {
 public:
  // Takes at least 2 ribs, offsets strictly ascending.
  explicit RibSpline(std::span<const RibFit> ribs);

  // Return the shape at an offset, whole or as the state at its middle. Before the first and behind the last
  // rib it changes on as it did, ever less, and no more from kFadeMm on (fade.hpp).
  [[nodiscard]] elastica::Elastica at(double offset_mm) const;
  [[nodiscard]] elastica::MidState mid_at(double offset_mm) const;

 private:
  using Values = Eigen::Matrix<double, 7, 1>;
  [[nodiscard]] Values values_at(double offset_mm) const;

  Eigen::Spline<double, 7> spline_;
  double first_ = 0, last_ = 0;
};

}  // namespace hotblade::pipeline
