#include "pipeline/plan/motion/rate_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hotblade::pipeline {

namespace {

// Changes from a squared rate x at the step's beginning to at most `most` at its end.
RateInterval allowed(std::span<const RateBound> bounds, double x, double most) {
  RateInterval u{-0.5 * x, 0.5 * (most - x)};
  for (const RateBound& bound : bounds) {
    if (u.empty()) break;
    bound.narrow(u, x);
  }
  return u;
}

// The largest squared rate up to `cap` from which the step's end is reached with at most `most`. Rates and
// changes that hold all bounds are a convex set around rest, so that bisection finds it.
double largest_rate2(std::span<const RateBound> bounds, double cap, double most) {
  if (!allowed(bounds, cap, most).empty()) return cap;
  double good = 0, bad = cap;
  constexpr double kClose = 1e-4;
  while (bad - good > kClose * bad && bad > std::numeric_limits<double>::min()) {
    // Rates differ by orders of magnitude: the middle by size while nothing is known to hold.
    const double x = good > 0 ? 0.5 * (good + bad) : 0.1 * bad;
    (allowed(bounds, x, most).empty() ? bad : good) = x;
  }
  return good;
}

}  // namespace

void RateBound::narrow(RateInterval& u, double x) const {
  const double b = pq * x, c = qq * x * x - most * most;
  const double under_root = b * b - pp * c;
  if (under_root < 0 || (pp == 0 && c > 0)) {
    u.high = u.low - 1;
    return;
  }
  if (pp == 0) return;
  const double root = std::sqrt(under_root);
  u.low = std::max(u.low, (-b - root) / pp);
  u.high = std::min(u.high, (-b + root) / pp);
}

std::vector<double> squared_rates(std::vector<double> most, std::span<const RateBound> bounds) {
  if (most.size() < 2 || bounds.size() % (most.size() - 1) != 0)
    throw std::logic_error("every step of a path needs as many bounds");
  const std::size_t steps = most.size() - 1, each = bounds.size() / steps;
  const auto of = [&](std::size_t i) { return bounds.subspan(i * each, each); };
  for (std::size_t i = steps; i-- > 0;) most[i] = largest_rate2(of(i), most[i], most[i + 1]);
  for (std::size_t i = 0; i < steps; ++i) {
    const RateInterval u = allowed(of(i), most[i], most[i + 1]);
    // Empty by rounding alone.
    if (!u.empty()) most[i + 1] = std::min(most[i + 1], std::max(0.0, most[i] + 2 * u.high));
  }
  return most;
}

}  // namespace hotblade::pipeline
