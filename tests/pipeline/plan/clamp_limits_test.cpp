// Limits of the clamps, narrowed: the plan slows its blade where it has to, and says where foam would melt
// too wide.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>

#include "pipeline/plan/plan.hpp"
#include "pipeline/settings/settings.hpp"
#include "surface/read/design_surface.hpp"
#include "tests/paths.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::json;

// What the clamps do at most, by differences of the waypoints that stand in a program's text alone.
struct Most {
  double speed = 0, accel = 0, turn = 0, turn_accel = 0;
};

Vector3d vector(const Json& p) {
  return {p[0].get<double>(), p[1].get<double>(), p[2].get<double>()};
}

// Angle times axis of the turn between orientations (w, x, y, z), from the matrices: another way than the
// plan's.
Vector3d turn_between(const Json& p, const Json& q) {
  const auto matrix = [](const Json& o) -> Eigen::Matrix3d {
    return Eigen::Quaterniond(o[0], o[1], o[2], o[3]).normalized().toRotationMatrix();
  };
  const Eigen::Matrix3d m = matrix(q) * matrix(p).transpose();
  const Vector3d twice_sine(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
  return 0.5 * twice_sine;  // steps turn by less than 0.05 rad: the sine is the angle to 4e-4 of it
}

Most measured(const Json& poses, const char* clamp) {
  Most most;
  Vector3d v = Vector3d::Zero(), w = Vector3d::Zero();
  double dt0 = 0;
  for (std::size_t i = 1; i <= poses.size(); ++i) {
    const bool rests = i == poses.size();
    const Json &p = poses[i - 1], &q = poses[rests ? i - 1 : i];
    const double dt = rests ? dt0 : q["t"].get<double>() - p["t"].get<double>();
    const Vector3d v1 = (vector(q[clamp]["p"]) - vector(p[clamp]["p"])) / dt,
                   w1 = turn_between(p[clamp]["q"], q[clamp]["q"]) / dt;
    const double mean = 0.5 * ((i == 1 ? dt : dt0) + dt);
    most.speed = std::max(most.speed, v1.norm());
    most.turn = std::max(most.turn, w1.norm());
    most.accel = std::max(most.accel, (v1 - v).norm() / mean);
    most.turn_accel = std::max(most.turn_accel, (w1 - w).norm() / mean);
    v = v1;
    w = w1;
    dt0 = dt;
  }
  return most;
}

Most measured(const PlanResult& result) {
  Most most;
  const Json program = Json::parse(to_json(result.program));
  for (const Json& strip : program["strips"]) {
    for (const char* clamp : {"a", "b"}) {
      const Most m = measured(strip["poses"], clamp);
      most = {std::max(most.speed, m.speed), std::max(most.accel, m.accel), std::max(most.turn, m.turn),
              std::max(most.turn_accel, m.turn_accel)};
    }
  }
  return most;
}

double duration_s(const PlanResult& result) {
  return std::accumulate(result.strips.begin(), result.strips.end(), 0.0,
                         [](double s, const StripFacts& f) { return s + f.motion.duration_s; });
}

PlanResult plan_sample(const std::string& name, const MotionSettings& motion) {
  const std::string base = hotblade::testing::source_dir() + "/samples/" + name;
  Settings settings = resolve({{base + ".toml"}, {}, {}});
  settings.motion = motion;
  return plan(surface::read_obj(base + ".obj", {settings.design.units, 'z'}), settings, {});
}

const PlanResult& usual(const std::string& name) {
  static std::map<std::string, PlanResult> plans;
  const auto at = plans.find(name);
  return at != plans.end() ? at->second : plans.emplace(name, plan_sample(name, {})).first->second;
}

// How much slower the usual motion would have to run as a whole to keep to other limits.
double slower(const Most& most, const MotionSettings& l) {
  return std::max({1.0, most.speed / l.travel_mm_s, most.turn / l.angular_rad_s,
                   std::sqrt(most.accel / l.accel_mm_s2),
                   std::sqrt(most.turn_accel / l.angular_accel_rad_s2)});
}

struct Narrowed {
  const char* limit;
  double MotionSettings::*which;
};

class ClampLimits : public ::testing::TestWithParam<std::tuple<const char*, Narrowed, int>> {};

TEST_P(ClampLimits, AreKeptByALawThatSlowsWhereItHasTo) {
  const auto& [sample, narrowed, factor] = GetParam();
  MotionSettings motion;
  motion.*narrowed.which /= factor;
  const PlanResult result = plan_sample(sample, motion);
  for (const Refusal& r : result.refusals) ADD_FAILURE() << describe(r);
  const Most most = measured(result);
  // The text has all digits of places and times.
  constexpr double kDigits = 1 + 1e-9, kSine = 1 + 5e-4;
  EXPECT_LE(most.speed, motion.travel_mm_s * kDigits);
  EXPECT_LE(most.accel, motion.accel_mm_s2 * kDigits);
  EXPECT_LE(most.turn, motion.angular_rad_s * kSine);
  EXPECT_LE(most.turn_accel, motion.angular_accel_rad_s2 * kSine);
  const double preheats = motion.preheat_s * static_cast<double>(result.strips.size());
  const double all_slowed =
      preheats + slower(measured(usual(sample)), motion) * (duration_s(usual(sample)) - preheats);
  EXPECT_LE(duration_s(result), all_slowed);
  EXPECT_GE(duration_s(result), 0.999 * duration_s(usual(sample)));
}

INSTANTIATE_TEST_SUITE_P(
    Samples, ClampLimits,
    ::testing::Combine(::testing::Values("barrel_vault", "s_wall"),
                       ::testing::Values(Narrowed{"acceleration", &MotionSettings::accel_mm_s2},
                                         Narrowed{"angular_speed", &MotionSettings::angular_rad_s},
                                         Narrowed{"angular_acceleration",
                                                  &MotionSettings::angular_accel_rad_s2}),
                       ::testing::Values(2, 5, 20)),
    [](const auto& p) {
      return std::string(std::get<0>(p.param)) + "_" + std::get<1>(p.param).limit + "_by_" +
             std::to_string(std::get<2>(p.param));
    });

const Refusal* slowest_feed(const PlanResult& result) {
  const auto at = std::find_if(result.refusals.begin(), result.refusals.end(),
                               [](const Refusal& r) { return r.limit == Limit::kSlowestFeed; });
  return at == result.refusals.end() ? nullptr : &*at;
}

TEST(ClampLimitsRefusal, NamesTheRibWhereFoamWouldMeltTooWideAndTheLimitThatHoldsTheBladeBack) {
  // Clamps so slow to start that the lead before the block is too short for them.
  MotionSettings motion;
  motion.accel_mm_s2 = 0.2;
  motion.min_feed_mm_s = 5;
  const PlanResult refused = plan_sample("s_wall", motion);
  const Refusal* const slow = slowest_feed(refused);
  ASSERT_NE(slow, nullptr);
  EXPECT_EQ(slow->rib.substr(0, slow->strip.size()), slow->strip);
  EXPECT_GT(slow->rib.size(), slow->strip.size());
  EXPECT_EQ(slow->bound, 5);
  EXPECT_LT(slow->value, 5);
  EXPECT_TRUE(slow->at.has_value());
  const std::string key = "motion.accel_mm_s2 of ";
  const std::size_t named = slow->note.find(key);
  ASSERT_NE(named, std::string::npos) << slow->note;
  // What the refusal says would help, does.
  motion.accel_mm_s2 = std::stod(slow->note.substr(named + key.size()));
  EXPECT_GT(motion.accel_mm_s2, 0.2);
  const PlanResult helped = plan_sample("s_wall", motion);
  EXPECT_EQ(slowest_feed(helped), nullptr) << describe(*slowest_feed(helped));
}

}  // namespace
}  // namespace hotblade::pipeline
