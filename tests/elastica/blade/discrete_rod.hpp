// A clamped blade as a chain of straight segments: an oracle that shares nothing with the library.
//
// Energy 1/2 sum (theta_i+1 - theta_i)^2 / h, half segments at the clamps, end point held by two multipliers.
// Second order in the segment length.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace hotblade::elastica::testing {

class DiscreteRod {
 public:
  // Length 1, from (0, 0) with tangent 0 to (x, y) with tangent `turning`.
  DiscreteRod(double x, double y, double turning, std::vector<double> angles)
      : x_(x), y_(y), turning_(turning), theta_(std::move(angles)), h_(1.0 / double(theta_.size())) {}

  // Newton's method on energy and constraints together: the critical point near the start.
  bool to_critical_point() {
    for (int i = 0; i < 40; ++i) {
      if (step(0, 1e9) < 1e-11) return true;
    }
    return false;
  }

  // Descends to a minimum: Newton steps with the Hessian made positive, then the critical point there.
  bool to_minimum() {
    for (int i = 0; i < 3000; ++i) {
      double shift = 0;
      while (negative_pivots(shift) > 0) shift = shift == 0 ? 1 * h_ : 2 * shift;
      if (step(shift, 0.3) < 1e-4) break;
    }
    return to_critical_point() && negative_eigenvalues() == 0;
  }

  [[nodiscard]] double energy() const {
    double sum = 0;
    for (std::size_t i = 0; i <= theta_.size(); ++i) sum += 0.5 * jump(i) * jump(i) / gap(i);
    return sum;
  }

  // Of the second variation with the end point held.
  [[nodiscard]] int negative_eigenvalues() const {
    const Bordered b = eliminate(0);
    const double det = b.schur.determinant();
    return b.negative + (det < 0 ? 1 : b.schur.trace() < 0 ? 2 : 0) - 2;
  }

  [[nodiscard]] int inflections() const {
    int count = 0;
    for (std::size_t i = 0; i < theta_.size(); ++i) count += jump(i) * jump(i + 1) < 0 ? 1 : 0;
    return count;
  }

  [[nodiscard]] const std::vector<double>& angles() const { return theta_; }

 private:
  struct Bordered {
    std::vector<double> pivot;
    std::vector<Eigen::Vector3d> solved;  // of gradient and both constraint gradients
    Eigen::Matrix2d schur;                // -C^T H^-1 C
    Eigen::Vector2d rhs;                  // C^T H^-1 gradient
    int negative = 0;
  };

  [[nodiscard]] double gap(std::size_t i) const { return i == 0 || i == theta_.size() ? h_ / 2 : h_; }
  [[nodiscard]] double jump(std::size_t i) const {
    return (i == theta_.size() ? turning_ : theta_[i]) - (i == 0 ? 0 : theta_[i - 1]);
  }
  [[nodiscard]] double diagonal(std::size_t i, double shift) const {
    return 1 / gap(i) + 1 / gap(i + 1) - h_ * (p_ * std::cos(theta_[i]) + q_ * std::sin(theta_[i])) + shift;
  }

  [[nodiscard]] int negative_pivots(double shift) const { return eliminate(shift).negative; }

  // Thomas' algorithm for the tridiagonal Hessian with three right sides.
  [[nodiscard]] Bordered eliminate(double shift) const {
    const std::size_t n = theta_.size();
    Bordered b;
    b.pivot.resize(n);
    b.solved.resize(n);
    std::vector<Eigen::Vector3d> right(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double c = std::cos(theta_[i]), s = std::sin(theta_[i]);
      right[i] = {jump(i) / gap(i) - jump(i + 1) / gap(i + 1) - h_ * p_ * s + h_ * q_ * c, -h_ * s, h_ * c};
      b.solved[i] = right[i];
      b.pivot[i] = diagonal(i, shift);
      if (i > 0) {
        const double factor = -1 / gap(i) / b.pivot[i - 1];
        b.pivot[i] -= factor * (-1 / gap(i));
        b.solved[i] -= factor * b.solved[i - 1];
      }
      b.negative += b.pivot[i] < 0 ? 1 : 0;
    }
    for (std::size_t i = n; i-- > 0;) {
      if (i + 1 < n) b.solved[i] += b.solved[i + 1] / gap(i + 1);
      b.solved[i] /= b.pivot[i];
    }
    b.schur.setZero();
    b.rhs.setZero();
    for (std::size_t i = 0; i < n; ++i) {
      b.schur -= right[i].tail<2>() * b.solved[i].tail<2>().transpose();
      b.rhs += right[i].tail<2>() * b.solved[i][0];
    }
    return b;
  }

  // One step, shortened to turn no segment by more than `most`; returns the largest turn wanted.
  double step(double shift, double most) {
    Eigen::Vector2d miss(-x_, -y_);
    for (const double t : theta_) miss += h_ * Eigen::Vector2d(std::cos(t), std::sin(t));
    const Bordered b = eliminate(shift);
    // H d + C m = -g, C^T d = -miss.
    const Eigen::Vector2d m = b.schur.inverse() * (b.rhs - miss);
    double largest = 0;
    std::vector<double> d(theta_.size());
    for (std::size_t i = 0; i < d.size(); ++i) {
      d[i] = -b.solved[i][0] - b.solved[i].tail<2>().dot(m);
      largest = std::max(largest, std::abs(d[i]));
    }
    const double scale = std::min(1.0, most / std::max(largest, 1e-300));
    for (std::size_t i = 0; i < d.size(); ++i) theta_[i] += scale * d[i];
    p_ += scale * m[0];
    q_ += scale * m[1];
    return largest;
  }

  double x_, y_, turning_;
  std::vector<double> theta_;
  double h_;
  double p_ = 0, q_ = 0;  // multipliers of the end point
};

}  // namespace hotblade::elastica::testing
