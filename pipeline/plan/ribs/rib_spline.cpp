#include "pipeline/plan/ribs/rib_spline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/plan/ribs/fade.hpp"

namespace hotblade::pipeline {

RibSpline::RibSpline(std::span<const RibFit> ribs, double on_mm)
    : first_(ribs.front().offset_mm), last_(ribs.back().offset_mm), on_mm_(on_mm) {
  const auto n = static_cast<Eigen::Index>(ribs.size());
  Eigen::Matrix<double, 7, Eigen::Dynamic> values(7, n);
  Eigen::RowVectorXd knots(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const RibFit& rib = ribs[static_cast<std::size_t>(i)];
    const elastica::MidState m = mid_state(rib.elastica);
    // Directions are unwrapped from rib to rib.
    const double before = i > 0 ? values(2, i - 1) : m.theta;
    const double theta = before + std::remainder(m.theta - before, 2 * std::numbers::pi);
    values.col(i) << m.x, m.y, theta, m.kappa, m.tension1, m.tension2, m.length;
    knots[i] = (rib.offset_mm - first_) / (last_ - first_);
  }
  const Eigen::Index degree = std::min<Eigen::Index>(3, n - 1);
  spline_ = Eigen::SplineFitting<Eigen::Spline<double, 7>>::Interpolate(values, degree, knots);
}

elastica::Elastica RibSpline::at(double offset_mm) const {
  return elastica::from_mid_state(mid_at(offset_mm));
}

RibSpline::Values RibSpline::values_at(double offset_mm) const {
  constexpr Eigen::Index kLength = 6;
  const double inside = std::clamp(offset_mm, first_, last_), w = (inside - first_) / (last_ - first_);
  if (inside == offset_mm) return spline_(w);
  const double past = faded_mm(offset_mm - inside, on_mm_) / (last_ - first_);
  const auto at_end = spline_.derivatives(w, 2);
  Values values = at_end.col(0) + past * at_end.col(1) + 0.5 * past * past * at_end.col(2);
  // A rib that gets shorter has some length left.
  const double length = at_end(kLength, 0), more = past * at_end(kLength, 1);
  values[kLength] = more < 0 ? length * std::exp(more / length) : length + more;
  return values;
}

elastica::MidState RibSpline::mid_at(double offset_mm) const {
  const Values m = values_at(offset_mm);
  return {m[0], m[1], m[2], m[3], m[4], m[5], m[6]};
}

}  // namespace hotblade::pipeline
