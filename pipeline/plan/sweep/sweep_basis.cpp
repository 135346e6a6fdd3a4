#include "pipeline/plan/sweep/sweep_basis.hpp"

#include <algorithm>
#include <stdexcept>

namespace hotblade::pipeline {

namespace {

constexpr int kDegree = 3;

}  // namespace

SweepBasis::SweepBasis(int count) : count_(count) {
  if (count <= kDegree) throw std::logic_error("a cubic spline needs at least 4 coefficients");
  knots_.assign(kDegree + 1, 0.0);
  for (int i = 2; i <= count - kDegree; ++i) knots_.push_back(static_cast<double>(i) / (count - 1));
  knots_.insert(knots_.end(), kDegree + 1, 1.0);
}

BasisValues SweepBasis::at(double share) const {
  const double w = std::clamp(share, 0.0, 1.0);
  const auto end = knots_.end() - (kDegree + 1);
  const auto above = std::min(std::upper_bound(knots_.begin() + kDegree, end, w), end);
  const auto span = static_cast<std::size_t>(above - knots_.begin() - 1);
  // Cox and de Boor's recursion, kept at the last step but one for the slope.
  std::array<double, 4> value{1, 0, 0, 0}, lower{};
  for (std::size_t d = 1; d <= kDegree; ++d) {
    lower = value;
    double carried = 0;
    for (std::size_t r = 0; r < d; ++r) {
      const double right = knots_[span + r + 1], left = knots_[span + r + 1 - d];
      const double part = lower[r] / (right - left);
      value[r] = carried + (right - w) * part;
      carried = (w - left) * part;
    }
    value[d] = carried;
  }
  BasisValues basis{static_cast<int>(span) - kDegree, value, {}};
  for (std::size_t r = 0; r < kDegree; ++r) {
    const double part = kDegree * lower[r] / (knots_[span + r + 1] - knots_[span + r + 1 - kDegree]);
    basis.slope[r] -= part;
    basis.slope[r + 1] += part;
  }
  return basis;
}

double SweepBasis::place(int coefficient) const {
  const auto i = static_cast<std::size_t>(coefficient);
  return (knots_[i + 1] + knots_[i + 2] + knots_[i + 3]) / kDegree;
}

std::array<double, 3> SweepBasis::second_difference(int first) const {
  const double a = place(first), b = place(first + 1), c = place(first + 2), mean = 1.0 / (count_ - 1);
  const double left = 2 * mean * mean / ((b - a) * (c - a)), right = 2 * mean * mean / ((c - b) * (c - a));
  return {left, -left - right, right};
}

}  // namespace hotblade::pipeline
