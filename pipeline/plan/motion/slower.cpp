#include "pipeline/plan/motion/slower.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "gpu/backend/stop.hpp"
#include "pipeline/plan/motion/rate_bounds.hpp"
#include "pipeline/plan/motion/smooth_law.hpp"
#include "robot/pose/rates.hpp"

namespace hotblade::pipeline {

namespace {

using Eigen::Vector3d;

// Shares of the limits that a law begins with. Accelerations: ramps of a hold and the bends of the path come
// on top.
constexpr double kTopSpeed = 0.98, kTopAccel = 0.6, kTopRamp = 0.4;
// A limit holds up to this use: times are rounded, and written and read as numbers of some digits.
constexpr double kUseHolds = 0.998;
// A place that exceeds a limit is brought to this use of it.
constexpr double kUseAimed = 0.985;
// Squared rate where nothing limits it.
constexpr double kUnlimited = 1e18;
// The window where no jerk is limited, which then takes nothing.
constexpr double kNoWindow_s = 1e-6;

bool moves(const LimitedWay& m, std::size_t from, std::size_t to) {
  return std::any_of(m.step.begin() + static_cast<std::ptrdiff_t>(from),
                     m.step.begin() + static_cast<std::ptrdiff_t>(to),
                     [](const Vector3d& s) { return s.squaredNorm() > 0; });
}

// The ways over each step, measured by the speeds that everything may have: what the path is told by.
std::vector<double> ways(std::span<const LimitedWay> moving) {
  std::vector<double> all(moving.front().step.size(), 0);
  for (const LimitedWay& m : moving) {
    for (std::size_t i = 0; i < all.size(); ++i) all[i] += m.step[i].squaredNorm() / (m.speed * m.speed);
  }
  for (double& way : all) way = std::sqrt(way);
  return all;
}

// Steps from one rest to the next: [from, to) of steps. Steps that stand still belong to none. A rest between
// moving steps shows as steps on both sides that are half as fast as those beyond, or slower: from rest with
// even acceleration they are a third.
struct Part {
  std::size_t from = 0, to = 0;
};

std::vector<Part> parts_between_rests(std::span<const double> t, const std::vector<double>& way) {
  const auto speed = [&](std::size_t step) { return way[step] / (t[step + 1] - t[step]); };
  const auto rest_before = [&](std::size_t step, std::size_t from) {
    if (step < from + 2 || step + 1 >= way.size() || !(way[step + 1] > 0)) return false;
    return speed(step) <= 0.5 * speed(step + 1) && speed(step - 1) <= 0.5 * speed(step - 2);
  };
  std::vector<Part> parts;
  std::size_t from = 0;
  const auto end_at = [&](std::size_t to) {
    if (to > from) parts.push_back({from, to});
    from = to;
  };
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (!(way[i] > 0)) {
      end_at(i);
      from = i + 1;
    } else if (rest_before(i, from)) {
      end_at(i);
    }
  }
  end_at(way.size());
  return parts;
}

// One part's law, which is lowered until it holds.
class PartLaw {
 public:
  PartLaw(std::span<const double> t, std::span<const LimitedWay> moving, const std::vector<double>& way,
          Part part)
      : part_(part), place_(1, 0.0), caps_(part.to - part.from + 1, kUnlimited) {
    for (std::size_t i = part.from; i < part.to; ++i) {
      place_.push_back(place_.back() + way[i]);
      double rate = way[i] / (t[i + 1] - t[i]);
      for (const LimitedWay& m : moving) {
        const double far = m.step[i].norm() / way[i];
        if (!(far > 0)) continue;
        rate = std::min(rate, kTopSpeed * m.speed / far);
        if (m.ramp_per_s > 0) rate = std::min(rate, kTopRamp * m.accel / (m.ramp_per_s * far));
      }
      for (const std::size_t k : {i, i + 1}) cap(k) = std::min(cap(k), rate * rate);
    }
    caps_.front() = caps_.back() = 0;
    for (const LimitedWay& m : moving) {
      if (std::isfinite(m.accel)) add_bounds(m);
      if (std::isfinite(m.jerk) && moves(m, part.from, part.to))
        window_s_ =
            std::max(window_s_, 2 * kTopAccel * std::min(m.accel, std::sqrt(m.speed * m.jerk)) / m.jerk);
    }
    // Bounds stand track by track; a step needs its own together.
    by_step();
  }

  [[nodiscard]] const Part& part() const { return part_; }
  [[nodiscard]] double window_s() const { return window_s_; }
  // Without the window.
  [[nodiscard]] double abrupt_s() const { return law().duration_s() - window_s_; }

  // Sets the steps of the part, each at least as long as it was.
  void time(std::span<const double> t, std::vector<double>& step_s) const {
    const SmoothLaw smooth = law();
    double before = 0;
    for (std::size_t i = part_.from; i < part_.to; ++i) {
      const std::size_t k = i - part_.from + 1;
      const double now = i + 1 == part_.to ? smooth.duration_s() : smooth.time_of(place_[k]);
      step_s[i] = std::max(t[i + 1] - t[i], stretch_ * (now - before));
      before = now;
    }
  }

  // Lowers the rates of the steps [from, to], or what of them is in the part, by a factor.
  void lower(std::size_t from, std::size_t to, double factor) {
    from = std::max(from, part_.from);
    to = std::min(to, part_.to - 1);
    if (left_.empty()) left_.assign(caps_.size(), 1);
    for (std::size_t i = from; i <= to; ++i)
      for (const std::size_t k : {i, i + 1}) left_[k - part_.from] = std::min(left_[k - part_.from], factor);
  }
  void apply() {
    if (left_.empty()) return;
    const std::vector<double> rate2 = squared_rates(caps_, bounds_);
    for (std::size_t i = 0; i < left_.size(); ++i) {
      if (left_[i] < 1) caps_[i] = std::min(caps_[i], rate2[i]) * left_[i] * left_[i];
    }
    left_.clear();
  }
  void stretch(double by) { stretch_ *= by; }

 private:
  double& cap(std::size_t waypoint) { return caps_[waypoint - part_.from]; }

  [[nodiscard]] SmoothLaw law() const { return {place_, squared_rates(caps_, bounds_), window_s_}; }

  // Of the acceleration at both ends of each step: derivatives by the path parameter, whose steps are uneven.
  void add_bounds(const LimitedWay& m) {
    const std::size_t n = part_.to - part_.from;
    const auto h = [&](std::size_t i) { return place_[i + 1] - place_[i]; };
    const auto slope = [&](std::size_t i) { return Vector3d(m.step[part_.from + i] / h(i)); };
    const auto first = [&](std::size_t k) -> Vector3d {
      if (k == 0) return slope(0);
      if (k == n) return slope(n - 1);
      return (h(k) * slope(k - 1) + h(k - 1) * slope(k)) / (h(k - 1) + h(k));
    };
    const auto second = [&](std::size_t k) -> Vector3d {
      if (k == 0 || k == n) return Vector3d::Zero();
      return 2 * (slope(k) - slope(k - 1)) / (h(k - 1) + h(k));
    };
    std::vector<RateBound>& own = tracks_.emplace_back();
    const double most = kTopAccel * m.accel;
    for (std::size_t i = 0; i < n; ++i) {
      own.emplace_back(first(i) / h(i), second(i), most);
      // The squared rate at the end is x + 2 u.
      own.emplace_back(first(i + 1) / h(i) + 2 * second(i + 1), second(i + 1), most);
    }
  }

  void by_step() {
    for (std::size_t i = 0; i < part_.to - part_.from; ++i) {
      for (const std::vector<RateBound>& own : tracks_) {
        bounds_.push_back(own[2 * i]);
        bounds_.push_back(own[2 * i + 1]);
      }
    }
    tracks_.clear();
  }

  Part part_;
  std::vector<double> place_, caps_, left_;
  std::vector<std::vector<RateBound>> tracks_;
  std::vector<RateBound> bounds_;
  double window_s_ = kNoWindow_s, stretch_ = 1;
};

// Times of whole microseconds from steps.
std::vector<double> times(double first, const std::vector<double>& step_s) {
  std::vector<double> t(1, first);
  double us = std::round(first * 1e6);
  for (const double step : step_s) {
    us += std::ceil(step * 1e6 - 1e-3);
    t.push_back(us * 1e-6);
  }
  return t;
}

std::vector<Use> all_uses(std::span<const double> t, std::span<const LimitedWay> moving) {
  std::vector<Use> all(t.size());
  for (const LimitedWay& m : moving) {
    const std::vector<Use> own = uses(t, m);
    for (std::size_t k = 0; k < all.size(); ++k) {
      all[k].speed = std::max(all[k].speed, own[k].speed);
      all[k].accel = std::max(all[k].accel, own[k].accel);
      all[k].jerk = std::max(all[k].jerk, own[k].jerk);
    }
  }
  return all;
}

double worst(const std::vector<Use>& all) {
  double most = 0;
  for (const Use& use : all) most = std::max(most, use.most());
  return most;
}

// The factor of the rate that brings a use to what is aimed at. A ramp's part of an acceleration goes with
// the rate alone.
double factor_of(const Use& use) {
  double factor = 1;
  if (use.speed > kUseHolds) factor = std::min(factor, kUseAimed / use.speed);
  if (use.accel > kUseHolds) factor = std::min(factor, std::sqrt(kUseAimed / use.accel));
  if (use.jerk > kUseHolds) factor = std::min(factor, std::cbrt(kUseAimed / use.jerk));
  return factor;
}

}  // namespace

std::vector<LimitedWay> moving_clamps(std::span<const BladePose> poses, const MotionSettings& l) {
  const auto limit = [](double jerk) { return jerk > 0 ? jerk : std::numeric_limits<double>::infinity(); };
  std::vector<LimitedWay> all;
  for (const auto clamp : {&BladePose::a, &BladePose::b}) {
    const std::string which = clamp == &BladePose::a ? "clamp a" : "clamp b";
    LimitedWay place{{}, l.travel_mm_s, l.accel_mm_s2, limit(l.jerk_mm_s3), 0, which};
    LimitedWay turn{{}, l.angular_rad_s,  l.angular_accel_rad_s2, limit(l.angular_jerk_rad_s3),
                    0,  which + "'s turn"};
    for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
      const robot::ClampRates step = robot::rates_between(poses[i].*clamp, poses[i + 1].*clamp, 1);
      place.step.push_back(step.linear);
      turn.step.push_back(step.angular);
    }
    all.push_back(std::move(place));
    all.push_back(std::move(turn));
  }
  return all;
}

std::vector<Use> uses(std::span<const double> t, const LimitedWay& m) {
  const std::size_t n = m.step.size();
  if (t.size() != n + 1 || n == 0) throw std::logic_error("waypoints need a step between each");
  std::vector<Use> all(n + 1);
  // Of the steps before: outside, as long as the first and the last, and at rest.
  double dt0 = t[1] - t[0], dt1 = dt0;
  Vector3d v = Vector3d::Zero(), accel = Vector3d::Zero();
  for (std::size_t k = 0; k <= n + 1; ++k) {
    const double dt = k < n ? t[k + 1] - t[k] : dt1;
    const Vector3d then = k < n ? Vector3d(m.step[k] / dt) : Vector3d::Zero();
    const Vector3d now = 2 * (then - v) / (dt1 + dt);
    const Vector3d jerk = 3 * (now - accel) / (dt0 + dt1 + dt);
    Use& use = all[std::min(k, n)];
    const double ramp = m.ramp_per_s * std::max(v.norm(), then.norm());
    use.speed = std::max(use.speed, v.norm() / m.speed);
    if (k <= n) use.accel = (now.norm() + ramp) / m.accel;
    use.jerk = std::max(use.jerk, jerk.norm() / m.jerk);
    v = then;
    accel = now;
    dt0 = dt1;
    dt1 = dt;
  }
  return all;
}

Slower slower(std::vector<double> t, std::span<const LimitedWay> moving) {
  if (worst(all_uses(t, moving)) <= 1) return {std::move(t), 0, 0};
  const std::vector<double> way = ways(moving);
  std::vector<PartLaw> laws;
  for (const Part& part : parts_between_rests(t, way)) laws.emplace_back(t, moving, way, part);
  std::vector<double> step_s;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) step_s.push_back(t[i + 1] - t[i]);
  Slower result;
  for (const PartLaw& law : laws)
    result.joints_s += std::max(0.0, law.abrupt_s() - (t[law.part().to] - t[law.part().from]));
  constexpr int kLocalTries = 60, kTries = 400;
  for (int i = 0; i < kTries; ++i) {
    gpu::stop_point();
    for (const PartLaw& law : laws) law.time(t, step_s);
    result.t = times(t.front(), step_s);
    const std::vector<Use> all = all_uses(result.t, moving);
    if (worst(all) <= kUseHolds) break;
    for (PartLaw& law : laws) {
      double least = 1;
      for (std::size_t k = law.part().from; k <= law.part().to; ++k) {
        const double factor = factor_of(all[k]);
        if (!(factor < 1)) continue;
        least = std::min(least, factor);
        // Rates are means over the window.
        const double from = result.t[k] - law.window_s() / 2, to = result.t[k] + law.window_s() / 2;
        std::size_t first = k > 1 ? k - 2 : 0, last = k + 1;
        while (first > law.part().from && result.t[first] > from) --first;
        while (last < law.part().to && result.t[last] < to) ++last;
        law.lower(first, last, std::max(0.5, factor));
      }
      if (i < kLocalTries) {
        law.apply();
      } else if (least < 1) {
        law.stretch(1 / least);
      }
    }
  }
  result.jerk_s = result.t.back() - t.back() - result.joints_s;
  return result;
}

std::size_t tightest(std::span<const double> t, std::span<const LimitedWay> moving, std::size_t waypoint) {
  constexpr double kAbout_s = 0.2;
  std::size_t best = 0;
  double most = 0;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const std::vector<Use> own = uses(t, moving[i]);
    for (std::size_t k = 0; k < own.size(); ++k) {
      if (std::abs(t[k] - t[waypoint]) > kAbout_s || !(own[k].most() > most)) continue;
      most = own[k].most();
      best = i;
    }
  }
  return best;
}

}  // namespace hotblade::pipeline
