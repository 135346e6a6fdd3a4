#include "robot/pose/limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

using testing::arc_waypoint;
using testing::kBladeLength_mm;
using testing::sample_waypoints;

struct Verdict {
  Limit code = Limit::kNone;
  std::size_t at = 0;
};

// What the stream breaks first, after a trip through the registers as in the controller.
Verdict judge(const std::vector<Waypoint>& waypoints, const MotionLimits& limits = {}) {
  LimitChecker checker(limits, kBladeLength_mm);
  for (std::size_t k = 0; k < waypoints.size(); ++k) {
    const auto decoded = protocol::decode_waypoint(*protocol::encode_waypoint(waypoints[k]));
    if (decoded.error != Limit::kNone) return {decoded.error, k};
    if (const auto code = checker.next(decoded.waypoint); code != Limit::kNone) return {code, k};
  }
  return {checker.finish(), waypoints.size() - 1};
}

// A straight run along x with a trapezoidal speed, quantised; what a planner at its limits makes.
std::vector<Waypoint> run_along_x(double speed, double accel, std::uint32_t dt_us) {
  std::vector<Waypoint> waypoints;
  const double dt = dt_us * 1e-6, ramp = speed / accel, cruise = 1, end = 2 * ramp + cruise;
  const auto place = [&](double t) {
    if (t < ramp) return accel * t * t / 2;
    if (t < ramp + cruise) return speed * (t - ramp / 2);
    const double left = std::max(end - t, 0.0);
    return speed * (ramp + cruise) - accel * left * left / 2;
  };
  for (std::uint32_t k = 0; k * dt < end + dt; ++k) {
    // An odd direction, so that all three axes are rounded.
    const Eigen::Vector3d along = Eigen::Vector3d(2, 3, 6) / 7 * place(k * dt);
    waypoints.push_back(
        arc_waypoint(k * dt_us, Eigen::Vector3d(0.1234567, 0.7654321, 900) + along, 0.12, 0.3, false));
  }
  return waypoints;
}

TEST(LimitChecker, AcceptsASmoothMotion) {
  EXPECT_EQ(judge(sample_waypoints(200)).code, Limit::kNone);
}

TEST(LimitChecker, AMotionExactlyAtItsLimitsPassesAtEveryStep) {
  for (const std::uint32_t dt_us : {5000u, 7777u, 10000u, 20000u, 33333u, 50000u}) {
    const auto verdict = judge(run_along_x(100, 500, dt_us));
    EXPECT_EQ(verdict.code, Limit::kNone)
        << info(verdict.code).fault << " at " << verdict.at << ", dt " << dt_us;
  }
}

TEST(LimitChecker, AFewPercentAboveALimitDoNotPass) {
  EXPECT_EQ(judge(run_along_x(102, 400, 50000)).code, Limit::kSpeed);
  EXPECT_EQ(judge(run_along_x(90, 520, 50000)).code, Limit::kAcceleration);
  // At 5 ms rounding hides up to 2 sqrt(3) um / dt^2 = 139 mm/s^2, and no more.
  EXPECT_EQ(judge(run_along_x(90, 700, 5000)).code, Limit::kAcceleration);
}

TEST(LimitChecker, AngularLimitsHoldPerClamp) {
  const auto turning = [](double rate, double accel) {
    std::vector<Waypoint> waypoints;
    const double dt = 0.05, ramp = rate / accel;
    for (std::uint32_t k = 0; k < 20; ++k) {
      const double t = k * dt, angle = t < ramp ? accel * t * t / 2 : rate * (t - ramp / 2);
      auto w = arc_waypoint(k * 50000, {0, 0, 900}, 0.12, 0, false);
      w.b.q = w.b.q * Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()));
      waypoints.push_back(w);
    }
    return judge(waypoints).code;
  };
  EXPECT_EQ(turning(1.05, 1.9), Limit::kAngularSpeed);
  EXPECT_EQ(turning(0.5, 2.2), Limit::kAngularAcceleration);
}

TEST(LimitChecker, TheStripHasToEndAtRest) {
  auto waypoints = run_along_x(100, 500, 50000);
  while (waypoints.size() > 15)
    waypoints.pop_back();  // ends at full speed: 100 mm/s in 50 ms are 2000 mm/s^2
  const auto verdict = judge(waypoints);
  EXPECT_EQ(verdict.code, Limit::kAcceleration);
  EXPECT_EQ(verdict.at, 14u);
}

struct Breakage {
  const char* name;
  Limit code;
  std::function<void(Waypoint&)> break_it;
};

TEST(LimitChecker, EveryLimitIsNamed) {
  const Breakage breakages[] = {
      {"below the table", Limit::kEnvelope, [](Waypoint& w) { w.a.p.z() = -0.001; }},
      {"outside in y", Limit::kEnvelope, [](Waypoint& w) { w.b.p.y() = 2000.001; }},
      {"chord", Limit::kChord,
       [](Waypoint& w) { w.b.p = w.a.p + Eigen::Vector3d(kBladeLength_mm + 0.003, 0, 0); }},
      {"time stands", Limit::kTime, [](Waypoint& w) { w.t_us -= 50000; }},
      {"time runs back", Limit::kTime, [](Waypoint& w) { w.t_us -= 60000; }},
      {"time step", Limit::kMinDt, [](Waypoint& w) { w.t_us -= 45002; }},
      {"jump", Limit::kSpeed, [](Waypoint& w) { w.a.p.z() += 6; }},
  };
  for (const auto& breakage : breakages) {
    auto waypoints = sample_waypoints(200);
    breakage.break_it(waypoints[100]);
    const auto verdict = judge(waypoints);
    EXPECT_EQ(verdict.code, breakage.code) << breakage.name << ": " << info(verdict.code).fault;
    EXPECT_EQ(verdict.at, 100u) << breakage.name;
  }
}

TEST(LimitChecker, TheLongestStepIsNoShortOne) {
  for (const std::uint32_t t_us : {0xFFFFFFFEu, 0xFFFFFFFFu}) {
    LimitChecker checker(MotionLimits{}, kBladeLength_mm);
    Waypoint w = sample_waypoints(200)[0];
    ASSERT_EQ(checker.next(w), Limit::kNone);
    w.t_us = t_us;
    EXPECT_EQ(checker.next(w), Limit::kNone) << t_us;
  }
}

TEST(LimitChecker, ARefusedWaypointIsNotPartOfTheStream) {
  LimitChecker checker(MotionLimits{}, kBladeLength_mm);
  const auto waypoints = sample_waypoints(200);
  ASSERT_EQ(checker.next(waypoints[0]), Limit::kNone);
  auto far_off = waypoints[1];
  far_off.a.p.x() += 50;
  EXPECT_NE(checker.next(far_off), Limit::kNone);
  EXPECT_EQ(checker.next(waypoints[1]), Limit::kNone);
}

TEST(LimitChecker, StartsAtAFlatArcOfTheBladeOnEitherSide) {
  const auto start = [](const Waypoint& w) { return judge({w}).code; };
  const Eigen::Vector3d middle(0, 0, 900);
  for (const double u : {0.10, 0.13, 0.17, -0.10, -0.17}) {
    for (const double yaw : {0.0, 1.0, -2.5}) {
      EXPECT_EQ(start(arc_waypoint(0, middle, u, yaw, false)), Limit::kNone) << u;
    }
  }
  EXPECT_EQ(start(arc_waypoint(0, middle, 0.09, 0, false)), Limit::kStartPose) << "too flat";
  EXPECT_EQ(start(arc_waypoint(0, middle, 0.2, 0, false)), Limit::kStartPose) << "bent too far";
  EXPECT_EQ(start(arc_waypoint(1, middle, 0.12, 0, false)), Limit::kTime);
  auto w = arc_waypoint(0, middle, 0.12, 0, false);
  w.b.p.x() -= 0.2;
  EXPECT_EQ(start(w), Limit::kStartPose) << "chord of another blade";
  w = arc_waypoint(0, middle, 0.12, 0, false);
  std::swap(w.a.q, w.b.q);
  EXPECT_EQ(start(w), Limit::kNone) << "the other side";
  w.b.q = w.a.q;
  EXPECT_EQ(start(w), Limit::kStartPose) << "an S";
  w = arc_waypoint(0, middle, 0.12, 0, false);
  w.b.q = w.b.q * Eigen::Quaterniond(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitX()));
  EXPECT_EQ(start(w), Limit::kStartPose) << "twisted";
}

}  // namespace
}  // namespace hotblade::robot
