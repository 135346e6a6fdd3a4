#include "pipeline/plan/motion/time_law.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pipeline/plan/motion/rate_bounds.hpp"
#include "robot/pose/limits.hpp"
#include "robot/pose/rates.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// Shares of the limits that a law begins with. Speeds: what differences of samples miss. Accelerations in
// air: at travel speed the ramp of a hold adds two fifths of the usual limit (robot/pose/motion.hpp). In foam
// feeds are slow, so that a ramp adds little.
constexpr double kSpeedShare = 0.98, kAirShare = 0.6, kFoamShare = 0.95;

// Squared rate where nothing limits it: a thousand million samples a second.
constexpr double kFree = 1e18;

// One moving thing with limits of its own: its way from each sample to the next.
struct Moving {
  std::vector<Vector3d> step;
  double speed = 0, accel = 0;

  // Its first and second derivatives by the sample's number; it is at rest at both ends.
  [[nodiscard]] Vector3d first(std::size_t i) const {
    if (i == 0) return step.front();
    return i == step.size() ? step.back() : Vector3d(0.5 * (step[i - 1] + step[i]));
  }
  [[nodiscard]] Vector3d second(std::size_t i) const {
    return i == 0 || i == step.size() ? Vector3d::Zero() : Vector3d(step[i] - step[i - 1]);
  }
};

std::array<Moving, kTracks> moving_things(const std::vector<PathSample>& samples, const MotionSettings& l) {
  std::array<Moving, kTracks> all;
  for (const Track t : {kPlaceA, kPlaceB}) all[t] = {{}, l.travel_mm_s, l.accel_mm_s2};
  for (const Track t : {kTurnA, kTurnB}) all[t] = {{}, l.angular_rad_s, l.angular_accel_rad_s2};
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const robot::ClampRates a = robot::rates_between(samples[i].a, samples[i + 1].a, 1),
                            b = robot::rates_between(samples[i].b, samples[i + 1].b, 1);
    all[kPlaceA].step.push_back(a.linear);
    all[kPlaceB].step.push_back(b.linear);
    all[kTurnA].step.push_back(a.angular);
    all[kTurnB].step.push_back(b.angular);
  }
  return all;
}

// The fastest point of the blade where it is in the block before or behind the step.
double block_step(const PathSample& a, const PathSample& b) {
  const bool before = a.block_to >= a.block_from, behind = b.block_to >= b.block_from;
  if ((!before && !behind) || a.along.empty() || b.along.empty()) return 0;
  const double from = std::min(before ? a.block_from : b.block_from, behind ? b.block_from : a.block_from),
               to = std::max(before ? a.block_to : b.block_to, behind ? b.block_to : a.block_to);
  const auto way = [&](double at) {
    const auto k = std::min(static_cast<std::size_t>(at), a.along.size() - 2);
    const double t = at - static_cast<double>(k);
    return ((1 - t) * (b.along[k] - a.along[k]) + t * (b.along[k + 1] - a.along[k + 1])).norm();
  };
  double step = std::max(way(from), way(to));
  for (double at = std::ceil(from); at <= to; ++at) step = std::max(step, way(at));
  return step;
}

// The fastest point of the blade in foam.
double foam_step(const PathSample& a, const PathSample& b) {
  double step = 0;
  for (std::size_t i = 0; i < std::min(a.in_foam.size(), b.in_foam.size()); ++i) {
    step = std::max(step, (b.in_foam[i] - a.in_foam[i]).norm());
  }
  return std::max(step, block_step(a, b));
}

// Largest squared path rates (samples a second) that the speeds allow.
std::vector<double> speed_caps(const std::vector<PathSample>& samples,
                               const std::array<Moving, kTracks>& moving, const MotionSettings& limits,
                               const LawShares& shares) {
  const std::size_t n = samples.size();
  std::vector<double> cap(n, kFree);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    double rate = std::sqrt(kFree);
    for (const Moving& m : moving) {
      const double way = m.step[i].norm();
      if (way > 0) rate = std::min(rate, kSpeedShare * m.speed / way);
    }
    const double foam = foam_step(samples[i], samples[i + 1]);
    if (foam > 0) rate = std::min(rate, limits.feed_mm_s / foam);
    cap[i] = std::min(cap[i], rate * rate);
    cap[i + 1] = std::min(cap[i + 1], rate * rate);
  }
  for (std::size_t i = 0; i < n; ++i) cap[i] *= shares.rate2[i];
  cap.front() = cap.back() = 0;
  return cap;
}

// What bounds the path acceleration of the step behind a sample, by its rate: each clamp's accelerations at
// both ends of the step.
std::vector<RateBound> step_bounds(const std::array<Moving, kTracks>& moving, const LawShares& shares) {
  std::vector<RateBound> all;
  all.reserve(2 * kTracks * moving.front().step.size());
  for (std::size_t i = 0; i < moving.front().step.size(); ++i) {
    for (std::size_t t = 0; t < kTracks; ++t) {
      const Moving& m = moving[t];
      const Vector3d bend = m.second(i), then = m.second(i + 1);
      all.emplace_back(m.first(i), bend, shares.accel[t][i] * m.accel);
      // The squared rate at the end is x + 2 u.
      all.emplace_back(m.first(i + 1) + 2 * then, then, shares.accel[t][i + 1] * m.accel);
    }
  }
  return all;
}

// An even step in whole microseconds: times are those of the waypoints.
void set_step(TimeLaw& law, double duration_s, double longest_s) {
  constexpr double kMicro = 1e-6;
  const double least_us = robot::MotionLimits{}.min_dt_us;
  const double most_us = std::max(least_us, std::floor(longest_s / kMicro + 1e-6));
  const double steps = std::max(1.0, std::ceil(duration_s / kMicro / most_us));
  law.step_s = std::max(least_us, std::ceil(duration_s / kMicro / steps)) * kMicro;
  law.duration_s = law.step_s * steps;
  law.sigma.resize(static_cast<std::size_t>(steps) + 1);
}

}  // namespace

LawShares first_shares(const std::vector<PathSample>& samples) {
  LawShares shares{std::vector<double>(samples.size(), 1.0), {}};
  std::vector<double> accel;
  for (const PathSample& sample : samples) accel.push_back(sample.in_foam.empty() ? kAirShare : kFoamShare);
  shares.accel.fill(accel);
  return shares;
}

TimeLaw fastest_time_law(const std::vector<PathSample>& samples, const MotionSettings& limits,
                         const LawShares& shares) {
  const std::size_t n = samples.size();
  if (n < 3) throw std::logic_error("a time law needs at least 3 samples");
  if (shares.rate2.size() != n ||
      std::any_of(shares.accel.begin(), shares.accel.end(), [n](const auto& s) { return s.size() != n; }))
    throw std::logic_error("a time law needs a share for each sample");
  const std::array<Moving, kTracks> moving = moving_things(samples, limits);
  TimeLaw law;
  const auto moves = [](const Moving& m) {
    return std::any_of(m.step.begin(), m.step.end(), [](const Vector3d& s) { return s.squaredNorm() > 0; });
  };
  if (std::none_of(moving.begin(), moving.end(), moves)) {
    law.sigma = {0, 1};
    return law;
  }
  const std::vector<double> rate2 =
      squared_rates(speed_caps(samples, moving, limits, shares), step_bounds(moving, shares));
  std::vector<double> time(n, 0.0);
  for (std::size_t i = 0; i + 1 < n; ++i)
    time[i + 1] = time[i] + 2 / (std::sqrt(rate2[i]) + std::sqrt(rate2[i + 1]));
  set_step(law, time.back(), limits.waypoint_s);
  const double share = time.back() / law.duration_s;
  std::size_t i = 0;
  for (std::size_t k = 0; k < law.sigma.size(); ++k) {
    const double t = share * law.step_s * static_cast<double>(k);
    while (i + 2 < n && time[i + 1] < t) ++i;
    const double tau = t - time[i], v0 = std::sqrt(rate2[i]), accel = 0.5 * (rate2[i + 1] - rate2[i]);
    const double inside = std::clamp(v0 * tau + 0.5 * accel * tau * tau, 0.0, 1.0);
    law.sigma[k] = (static_cast<double>(i) + inside) / static_cast<double>(n - 1);
  }
  law.sigma.back() = 1;
  return law;
}

}  // namespace hotblade::pipeline
