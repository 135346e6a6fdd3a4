// Waypoints met later: limits of clamps and joints hold, at the place of each, and nothing else changes.
#include "pipeline/plan/motion/slower.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "pipeline/plan/motion/smooth_law.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;

// Places at even times, from rest to rest with even acceleration: 100 mm/s, 400 mm/s2.
constexpr double kStep_s = 0.05, kSpeed = 100, kAccel = 400;

double trapezoid(double t, double way) {
  const double ramp = kSpeed / kAccel, whole = way / kSpeed + ramp;
  if (t < ramp) return 0.5 * kAccel * t * t;
  if (t > whole - ramp) return way - 0.5 * kAccel * std::pow(std::max(0.0, whole - t), 2);
  return kSpeed * (t - ramp / 2);
}

struct Line {
  std::vector<double> t;
  LimitedWay moving{{}, kSpeed, 2 * kAccel, 10 * kAccel, 0, "line"};
};

// A way of 400 mm along x, at rest half-way too where asked; `bent` takes millimetres along it elsewhere.
Line line(
    bool with_rest,
    const std::function<Vector3d(double)>& bent = [](double x) { return Vector3d(x, 0, 0); }) {
  Line one;
  std::vector<double> along;
  const int parts = with_rest ? 2 : 1;
  const double way = 400.0 / parts, whole = way / kSpeed + kSpeed / kAccel;
  for (int part = 0; part < parts; ++part) {
    const int steps = static_cast<int>(std::lround(whole / kStep_s));
    for (int i = part == 0 ? 0 : 1; i <= steps; ++i) {
      one.t.push_back(std::round(1e6 * (part * whole + i * kStep_s)) * 1e-6);
      along.push_back(part * way + trapezoid(i * kStep_s, way));
    }
  }
  for (std::size_t i = 0; i + 1 < along.size(); ++i)
    one.moving.step.push_back(bent(along[i + 1]) - bent(along[i]));
  return one;
}

double most(const std::vector<double>& t, const LimitedWay& moving) {
  double worst = 0;
  for (const Use& use : uses(t, moving)) worst = std::max(worst, use.most());
  return worst;
}

TEST(Uses, AreSharesOfTheLimitsByDifferences) {
  Line one = line(false);
  one.moving.accel = 200;
  one.moving.jerk = 1000;
  const std::vector<Use> all = uses(one.t, one.moving);
  EXPECT_NEAR(all[1].speed, 0.5 * kAccel * kStep_s / kSpeed, 1e-9);
  EXPECT_NEAR(all[2].accel, kAccel / 200, 1e-9);
  EXPECT_NEAR(all[20].accel, 0, 1e-9);
  EXPECT_NEAR(all[20].speed, 1, 1e-9);
  // From 0 to 400 mm/s2 over three steps of which the first stands still, and a third difference.
  EXPECT_NEAR(all[0].jerk, 0.5 * kAccel / kStep_s / 1000, 1e-9);
  EXPECT_GT(all.back().jerk, 0);
  one.moving.ramp_per_s = 2;
  EXPECT_NEAR(uses(one.t, one.moving)[20].accel, 2 * kSpeed / 200, 1e-9);
}

TEST(Slower, LeavesTimesThatHoldAsTheyAre) {
  Line one = line(true);
  one.moving.speed = 1.01 * kSpeed;
  one.moving.accel = one.moving.jerk = 1e9;
  EXPECT_EQ(slower(one.t, std::vector{one.moving}).t, one.t);
}

TEST(Slower, KeepsJerkForLittleTime) {
  for (const bool with_rest : {false, true}) {
    const Line one = line(with_rest);
    ASSERT_GT(most(one.t, one.moving), 1);
    const Slower law = slower(one.t, std::vector{one.moving});
    EXPECT_LE(most(law.t, one.moving), 1);
    for (std::size_t i = 1; i < law.t.size(); ++i)
      EXPECT_GE(law.t[i] - law.t[i - 1], one.t[i] - one.t[i - 1] - 1e-9) << "faster than before";
    EXPECT_LE(law.t.back() - one.t.back(), with_rest ? 1.2 : 0.6);
    EXPECT_GT(law.jerk_s, 0);
    EXPECT_NEAR(law.joints_s + law.jerk_s, law.t.back() - one.t.back(), 1e-9);
    for (const double t : law.t) EXPECT_NEAR(t * 1e6, std::round(t * 1e6), 1e-6);
    // What holds is left alone.
    EXPECT_EQ(slower(law.t, std::vector{one.moving}).t, law.t);
  }
}

TEST(Slower, SlowsAtThePlaceOfTheLimitAlone) {
  Line one = line(false);
  one.moving.jerk = one.moving.accel = 1e9;
  // A joint that turns from 180 to 220 mm, and may do so at a tenth of the speed.
  LimitedWay joint{{}, 0.2, 1e9, 1e9, 0, "joint"};
  double x = 0;
  std::vector<double> at{0};
  for (const Vector3d& step : one.moving.step) {
    const auto angle = [](double p) { return 0.02 * std::clamp(p - 180, 0.0, 40.0); };
    joint.step.emplace_back(angle(x + step.x()) - angle(x), 0, 0);
    x += step.x();
    at.push_back(x);
  }
  const std::vector<LimitedWay> moving{one.moving, joint};
  const Slower law = slower(one.t, moving);
  EXPECT_LE(most(law.t, joint), 1);
  for (std::size_t i = 1; i < law.t.size(); ++i) {
    const double before = one.t[i] - one.t[i - 1], now = law.t[i] - law.t[i - 1];
    if (at[i] < 160 && at[i - 1] > 30) {
      EXPECT_LT(now, 1.2 * before) << at[i];
    }
    if (at[i - 1] > 190 && at[i] < 210) {
      EXPECT_GT(now, 9 * before) << at[i];
    }
  }
  EXPECT_EQ(tightest(one.t, moving, one.t.size() / 2), 1U);
  EXPECT_NEAR(law.joints_s, 40 / 10.0 - 0.4, 0.5);
}

TEST(Slower, LeavesTheRampOfAHoldToAJoint) {
  Line one = line(false);
  one.moving.accel = 300;
  one.moving.ramp_per_s = 2;
  ASSERT_GT(most(one.t, one.moving), 1);
  const Slower law = slower(one.t, std::vector{one.moving});
  EXPECT_LE(most(law.t, one.moving), 1);
  EXPECT_GT(most(law.t, one.moving), 0.5);
}

TEST(Slower, KeepsDwells) {
  Line one = line(false);
  LimitedWay twice = one.moving;
  std::vector<double> t = one.t;
  for (int i = 1; i <= 40; ++i) t.push_back(std::round(1e6 * (one.t.back() + i * kStep_s)) * 1e-6);
  twice.step.resize(twice.step.size() + 40, Vector3d::Zero());
  const double there = t.back();
  for (const double s : one.t)
    if (s > 0) t.push_back(std::round(1e6 * (there + s)) * 1e-6);
  twice.step.insert(twice.step.end(), one.moving.step.begin(), one.moving.step.end());
  const Slower law = slower(t, std::vector{twice});
  EXPECT_LE(most(law.t, twice), 1);
  const std::size_t from = one.t.size() - 1;
  EXPECT_NEAR(law.t[from + 40] - law.t[from], 2, 1e-9);
}

TEST(SmoothLaw, ItsRatesAreThoseOfItsPlaces) {
  std::vector<double> place, rate2;
  for (int i = 0; i <= 40; ++i) {
    place.push_back(i + 0.3 * std::sin(i));
    rate2.push_back(900 * std::sin(M_PI * i / 40) * (1.2 + std::cos(0.7 * i)));
  }
  rate2.back() = 0;
  const SmoothLaw law(place, rate2, 0.2);
  EXPECT_EQ(law.place(0), 0);
  EXPECT_NEAR(law.place(law.duration_s()), place.back(), 1e-9);
  for (const double t : {0.0, law.duration_s()}) EXPECT_NEAR(law.rate(t), 0, 1e-9);
  constexpr double h = 1e-5;
  double before = 0;
  for (double t = h; t < law.duration_s() - h; t += 0.00731) {
    EXPECT_GE(law.place(t), before);
    before = law.place(t);
    EXPECT_NEAR((law.place(t + h) - law.place(t - h)) / (2 * h), law.rate(t), 1e-4);
    EXPECT_NEAR(law.time_of(before), t, 1e-8);
  }
}

}  // namespace
}  // namespace hotblade::pipeline
