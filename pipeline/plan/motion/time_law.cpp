#include "pipeline/plan/motion/time_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hotblade::pipeline {

namespace {

// Share of each acceleration limit that the law uses: the rest covers second differences of sampled,
// quantised waypoints and the two terms of the chain rule meeting (0.5 for each of bending and speeding up).
constexpr double kAccelShare = 0.6;
constexpr double kBendShare = 0.5;
// Share of each speed limit: covers differences of quantised times and positions.
constexpr double kSpeedShare = 0.98;

// First and second differences of one moving thing per path step, with its limits.
struct Track {
  std::vector<double> first, second;  // |p'| per step, |p''| per sample, by path index
  double speed = 0, accel = 0;
};

double angle_between(const Eigen::Quaterniond& p, const Eigen::Quaterniond& q) {
  return 2 * std::atan2((p.conjugate() * q).vec().norm(), std::abs((p.conjugate() * q).w()));
}

Eigen::Vector3d turn(const Eigen::Quaterniond& p, const Eigen::Quaterniond& q) {
  Eigen::Quaterniond d = q * p.conjugate();
  if (d.w() < 0) d.coeffs() = -d.coeffs();
  const double s = d.vec().norm();
  return s > 0 ? Eigen::Vector3d(d.vec() / s * 2 * std::atan2(s, d.w())) : Eigen::Vector3d::Zero();
}

Track clamp_track(const std::vector<PathSample>& samples, robot::Pose PathSample::*clamp,
                  const MotionSettings& l) {
  Track t{{}, std::vector<double>(samples.size(), 0.0), l.travel_mm_s, l.accel_mm_s2};
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    t.first.push_back(((samples[i + 1].*clamp).p - (samples[i].*clamp).p).norm());
    if (i > 0) {
      t.second[i] =
          ((samples[i + 1].*clamp).p - 2 * (samples[i].*clamp).p + (samples[i - 1].*clamp).p).norm();
    }
  }
  return t;
}

Track turning_track(const std::vector<PathSample>& samples, robot::Pose PathSample::*clamp,
                    const MotionSettings& l) {
  Track t{{}, std::vector<double>(samples.size(), 0.0), l.angular_rad_s, l.angular_accel_rad_s2};
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    t.first.push_back(angle_between((samples[i].*clamp).q, (samples[i + 1].*clamp).q));
    if (i > 0) {
      t.second[i] = (turn((samples[i].*clamp).q, (samples[i + 1].*clamp).q) -
                     turn((samples[i - 1].*clamp).q, (samples[i].*clamp).q))
                        .norm();
    }
  }
  return t;
}

// The fastest point of the blade in foam.
double foam_step(const PathSample& a, const PathSample& b) {
  double step = 0;
  for (std::size_t i = 0; i < std::min(a.in_foam.size(), b.in_foam.size()); ++i) {
    step = std::max(step, (b.in_foam[i] - a.in_foam[i]).norm());
  }
  return step;
}

// Squared path rates (per index step, 1/s^2) at the samples: capped, then made reachable from both ends.
std::vector<double> squared_rates(const std::vector<PathSample>& samples, const std::vector<Track>& tracks,
                                  const MotionSettings& limits) {
  const std::size_t n = samples.size();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  std::vector<double> cap(n, kInf);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    double rate = kInf;
    for (const Track& t : tracks) {
      if (t.first[i] > 0) rate = std::min(rate, kSpeedShare * t.speed / t.first[i]);
    }
    const double foam = foam_step(samples[i], samples[i + 1]);
    if (foam > 0) rate = std::min(rate, limits.feed_mm_s / foam);
    cap[i] = std::min(cap[i], rate * rate);
    cap[i + 1] = std::min(cap[i + 1], rate * rate);
  }
  for (const Track& t : tracks) {
    for (std::size_t i = 0; i < n; ++i) {
      if (t.second[i] > 0) cap[i] = std::min(cap[i], kAccelShare * kBendShare * t.accel / t.second[i]);
    }
  }
  const auto push = [&](std::size_t step) {
    double most = kInf;  // of path acceleration over this step
    for (const Track& t : tracks) {
      if (t.first[step] > 0) most = std::min(most, kAccelShare * (1 - kBendShare) * t.accel / t.first[step]);
    }
    return most;
  };
  cap.front() = cap.back() = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) cap[i + 1] = std::min(cap[i + 1], cap[i] + 2 * push(i));
  for (std::size_t i = n - 1; i > 0; --i) cap[i - 1] = std::min(cap[i - 1], cap[i] + 2 * push(i - 1));
  return cap;
}

}  // namespace

TimeLaw fastest_time_law(const std::vector<PathSample>& samples, const MotionSettings& limits) {
  if (samples.size() < 3) throw std::logic_error("a time law needs at least 3 samples");
  const std::vector<Track> tracks{
      clamp_track(samples, &PathSample::a, limits), clamp_track(samples, &PathSample::b, limits),
      turning_track(samples, &PathSample::a, limits), turning_track(samples, &PathSample::b, limits)};
  const std::vector<double> rate2 = squared_rates(samples, tracks, limits);
  const std::size_t n = samples.size();
  std::vector<double> time(n, 0.0);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double mean = 0.5 * (std::sqrt(rate2[i]) + std::sqrt(rate2[i + 1]));
    time[i + 1] = time[i] + (std::isfinite(mean) && mean > 0 ? 1 / mean : 0);
  }
  TimeLaw law;
  law.duration_s = time.back();
  if (!(law.duration_s > 0)) {
    law.sigma = {0, 1};
    return law;
  }
  const auto steps = static_cast<std::size_t>(std::max(1.0, std::ceil(law.duration_s / limits.waypoint_s)));
  law.step_s = law.duration_s / static_cast<double>(steps);
  std::size_t i = 0;
  for (std::size_t k = 0; k <= steps; ++k) {
    const double t = law.step_s * static_cast<double>(k);
    while (i + 2 < n && time[i + 1] < t) ++i;
    const double tau = t - time[i], v0 = std::sqrt(rate2[i]), accel = 0.5 * (rate2[i + 1] - rate2[i]);
    const double inside = std::clamp(v0 * tau + 0.5 * accel * tau * tau, 0.0, 1.0);
    law.sigma.push_back((static_cast<double>(i) + inside) / static_cast<double>(n - 1));
  }
  law.sigma.back() = 1;
  return law;
}

}  // namespace hotblade::pipeline
