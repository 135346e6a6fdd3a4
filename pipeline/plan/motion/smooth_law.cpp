#include "pipeline/plan/motion/smooth_law.hpp"

#include <algorithm>
#include <cmath>

namespace hotblade::pipeline {

SmoothLaw::SmoothLaw(std::vector<double> place, const std::vector<double>& rate2, double window_s)
    : window_s_(window_s), place_(std::move(place)) {
  for (const double r : rate2) rate_.push_back(std::sqrt(r));
  time_.assign(1, 0);
  area_.assign(1, 0);
  for (std::size_t i = 0; i + 1 < rate_.size(); ++i) {
    const double way = place_[i + 1] - place_[i], step = 2 * way / (rate_[i] + rate_[i + 1]);
    const double accel = (rate2[i + 1] - rate2[i]) / (2 * way);
    time_.push_back(time_.back() + step);
    area_.push_back(area_.back() + step * (place_[i] + step * (rate_[i] / 2 + step * accel / 6)));
  }
}

SmoothLaw::Abrupt SmoothLaw::abrupt(double t) const {
  if (t <= 0) return {};
  if (t >= time_.back()) return {area_.back() + (t - time_.back()) * place_.back(), place_.back()};
  const auto i =
      static_cast<std::size_t>(std::upper_bound(time_.begin(), time_.end(), t) - time_.begin()) - 1;
  const double tau = t - time_[i], v0 = rate_[i];
  const double accel = (rate_[i + 1] - v0) / (time_[i + 1] - time_[i]);
  // The last rate is 0, and rounding must not leave the path's end.
  return {area_[i] + tau * (place_[i] + tau * (v0 / 2 + tau * accel / 6)),
          std::min(place_[i] + tau * (v0 + 0.5 * accel * tau), place_[i + 1])};
}

double SmoothLaw::place(double t) const {
  return std::clamp((abrupt(t).area - abrupt(t - window_s_).area) / window_s_, 0.0, place_.back());
}

double SmoothLaw::rate(double t) const {
  return (abrupt(t).place - abrupt(t - window_s_).place) / window_s_;
}

double SmoothLaw::time_of(double at) const {
  double low = 0, high = duration_s();
  constexpr double kClose_s = 1e-9;
  while (high - low > kClose_s) {
    const double middle = 0.5 * (low + high);
    (place(middle) < at ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace hotblade::pipeline
