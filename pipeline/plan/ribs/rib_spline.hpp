// A strip between its ribs: the states at the ribs' middles interpolated over the sweep by a cubic spline. An
// interpolated state is again an exact elastica.
#pragma once

#include <span>
#include <unsupported/Eigen/Splines>

#include "pipeline/plan/ribs/rib_fit.hpp"

namespace hotblade::pipeline {

class RibSpline {
 public:
  // At least 2 ribs, offsets strictly ascending.
  explicit RibSpline(std::span<const RibFit> ribs);

  // Before the first and behind the last rib the end shape is kept.
  [[nodiscard]] elastica::Elastica at(double offset_mm) const;
  [[nodiscard]] elastica::MidState mid_at(double offset_mm) const;

 private:
  Eigen::Spline<double, 7> spline_;
  double first_ = 0, last_ = 0;
};

}  // namespace hotblade::pipeline
