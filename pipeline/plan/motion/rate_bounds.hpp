// What limits of acceleration leave of the rate along a path: the fastest law from rest to rest below them.
//
// Between neighbouring samples of a path the squared rate changes evenly, by twice u. An acceleration is
// p u + q x at a squared rate x, so that its limit allows an interval of u at every x.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace hotblade::pipeline {

// The changes allowed; none where low > high.
struct RateInterval {
  double low = 0, high = 0;
  [[nodiscard]] bool empty() const { return !(low <= high); }
};

// |p u + q x| <= most.
struct RateBound {
  double pp = 0, pq = 0, qq = 0, most = 0;

  RateBound() = default;
  RateBound(const Eigen::Vector3d& p, const Eigen::Vector3d& q, double limit)
      : pp(p.squaredNorm()), pq(p.dot(q)), qq(q.squaredNorm()), most(limit) {}

  void narrow(RateInterval& u, double x) const;
};

// Returns the largest squared rates at the samples, from at most those given, which are 0 at both ends: a
// backward pass finds the largest from which the rest can still be held, a forward pass the fastest law below
// it. `bounds` holds the same number for every step, step by step.
[[nodiscard]] std::vector<double> squared_rates(std::vector<double> most, std::span<const RateBound> bounds);

}  // namespace hotblade::pipeline
