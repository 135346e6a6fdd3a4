// A strip between its ribs: the states at the ribs' middles interpolated over the sweep by a cubic spline. An
// interpolated state is again an exact elastica.
#pragma once

#include <span>
#include <unsupported/Eigen/Splines>

#include "pipeline/plan/ribs/rib_fit.hpp"

namespace hotblade::pipeline {

class RibSpline {
 public:
  // Takes at least 2 ribs, offsets strictly ascending, and how far past the ends shapes go on changing as
  // they did.
  explicit RibSpline(std::span<const RibFit> ribs, double on_mm = 0);

  // Return the shape at an offset, whole or as the state at its middle. Before the first and behind the last
  // rib it changes on as it did, from `on_mm` on ever less, and no more from kFadeMm behind that (fade.hpp).
  [[nodiscard]] elastica::Elastica at(double offset_mm) const;
  [[nodiscard]] elastica::MidState mid_at(double offset_mm) const;

 private:
  using Values = Eigen::Matrix<double, 7, 1>;
  [[nodiscard]] Values values_at(double offset_mm) const;

  Eigen::Spline<double, 7> spline_;
  double first_ = 0, last_ = 0, on_mm_ = 0;
};

}  // namespace hotblade::pipeline
