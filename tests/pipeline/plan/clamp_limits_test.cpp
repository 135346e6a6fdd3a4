// Limits of the clamps, narrowed: the plan slows its blade where it has to, and says where foam would melt
// too wide.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <string>

#include "pipeline/plan/plan.hpp"
#include "pipeline/settings/settings.hpp"
#include "surface/read/design_surface.hpp"
#include "tests/paths.hpp"
#include "tests/pipeline/clamp_motion.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

using testing::measured;
using testing::Most;

double duration_s(const PlanResult& result) {
  return std::accumulate(result.strips.begin(), result.strips.end(), 0.0,
                         [](double s, const StripFacts& f) { return s + f.motion.duration_s; });
}

std::string sample_path(const std::string& name) {
  return hotblade::testing::source_dir() + "/samples/" + name;
}

Settings settings_of(const std::string& name) {
  return resolve({{sample_path(name) + ".toml"}, {}, {}});
}

PlanResult plan_sample(const std::string& name, const Settings& settings) {
  return plan(surface::read_obj(sample_path(name) + ".obj", {settings.design.units, 'z'}), settings, {});
}

PlanResult plan_sample(const std::string& name, const MotionSettings& motion) {
  Settings settings = settings_of(name);
  settings.motion = motion;
  return plan_sample(name, settings);
}

const PlanResult& usual(const std::string& name) {
  static std::map<std::string, PlanResult> plans;
  const auto at = plans.find(name);
  return at != plans.end() ? at->second
                           : plans.emplace(name, plan_sample(name, MotionSettings{})).first->second;
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

// A wave cut askew: planes stand across a corner of it at first, so that the blade lies in waste for the most
// of its block, turns, and goes the fastest there.
TEST(ClampLimitsRefusal, NamesTheFeedWhereAPointInTheWasteBesideTheDesignHasIt) {
  const surface::DesignSurface wave = grid_design("wave", 70, 30, [](double u, double v) {
    return Eigen::Vector3d(700 * u, 300 * v, 50 * std::sin(2 * std::numbers::pi * u));
  });
  Settings settings = back_kept();
  settings.slice.direction = {{0.7166, 0.6975, -0.0049}};
  settings.motion.min_feed_mm_s = settings.motion.feed_mm_s;
  const PlanResult refused = plan(wave, settings, {});
  // That of the whole, before it was split.
  ASSERT_FALSE(refused.decisions.empty());
  const std::optional<Refusal>& slow = refused.decisions.front().stopped_by;
  ASSERT_TRUE(slow && slow->limit == Limit::kSlowestFeed);
  EXPECT_LT(slow->value, 0.9 * settings.motion.feed_mm_s);
  EXPECT_NE(slow->note.find("in the waste beside the design"), std::string::npos) << slow->note;
  const std::string key = "motion.feed_mm_s of ";
  const std::size_t named = slow->note.find(key);
  ASSERT_NE(named, std::string::npos) << slow->note;
  EXPECT_EQ(slow->note.find("e+"), std::string::npos) << "as settings are written: " << slow->note;
  // What the refusal says would help, does.
  settings.motion.feed_mm_s = std::stod(slow->note.substr(named + key.size()));
  EXPECT_LT(settings.motion.feed_mm_s, 2 * settings.motion.min_feed_mm_s);
  const PlanResult helped = plan(wave, settings, {});
  EXPECT_EQ(slowest_feed(helped), nullptr) << describe(*slowest_feed(helped));
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

TEST(ClampLimitsRefusal, IsNoneByRounding) {
  MotionSettings motion;
  motion.min_feed_mm_s = motion.feed_mm_s;
  // The window is a cylinder: each point has the feed, but for 0.001 mm/s.
  const PlanResult even = plan_sample("window", motion);
  EXPECT_EQ(slowest_feed(even), nullptr) << describe(*slowest_feed(even));
  motion.feed_mm_s *= 1.002;
  motion.min_feed_mm_s = motion.feed_mm_s * 1.002;
  EXPECT_NE(slowest_feed(plan_sample("window", motion)), nullptr);
  // The lowest clamp stands on the table, at 3e-9 mm below it.
  Settings on_table = settings_of("bump");
  on_table.stock.clearance_mm = 0;
  on_table.machine.plinth_mm = 20;
  const PlanResult standing = plan_sample("bump", on_table);
  EXPECT_TRUE(standing.refusals.empty()) << describe(standing.refusals.front());
  on_table.machine.plinth_mm = 19.9999;
  const PlanResult below = plan_sample("bump", on_table);
  ASSERT_FALSE(below.refusals.empty());
  EXPECT_EQ(below.refusals.front().limit, Limit::kClampHeight);
}

}  // namespace
}  // namespace hotblade::pipeline
