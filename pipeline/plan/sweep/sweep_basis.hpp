// Cubic splines over the sweep, by their coefficients.
//
// The knots are those of the cubic that interpolates values at evenly spaced places (the second and the last
// but one place are no knots). A spline of m coefficients is thus the interpolating spline of its own values
// at m evenly spaced ribs (RibSpline), and a strip moves on exactly the family that was fitted.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace hotblade::pipeline {

// Four coefficients count at a place: those from `first` on, with these weights, sum 1.
struct BasisValues {
  int first = 0;
  std::array<double, 4> value{}, slope{};  // slope: for a unit of the share
};

class SweepBasis {
 public:
  // At least 4 coefficients (std::logic_error).
  explicit SweepBasis(int count);

  [[nodiscard]] int count() const { return count_; }
  // At a share of the way, 0 to 1; clamped.
  [[nodiscard]] BasisValues at(double share) const;
  // Share at which a coefficient counts most: the mean of its three inner knots.
  [[nodiscard]] double place(int coefficient) const;
  // Weights of three coefficients from `first` on whose sum is the spline's second divided difference there,
  // times the square of the mean distance between coefficients: second differences where those are even.
  [[nodiscard]] std::array<double, 3> second_difference(int first) const;

 private:
  int count_;
  std::vector<double> knots_;
};

}  // namespace hotblade::pipeline
