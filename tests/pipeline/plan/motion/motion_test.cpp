#include "pipeline/plan/motion/motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "pipeline/plan/sweep/sweep_search.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

struct Planned {
  StripPlan strip;
  BladeMotion motion;
};

const Planned& planned() {
  static const Planned p = [] {
    const Settings settings = along_x();
    std::vector<StripPlan> strips;
    const auto take = [&](const SweptPlan& swept) -> SweepVerdict {
      strips = swept.strips;
      return {true, {}};
    };
    (void)search_sweeps(cylinder_design(), settings, {take, take});
    if (strips.size() != 1) throw std::runtime_error("the cylinder makes one strip");
    return Planned{strips.front(), move_blade(strips.front(), settings)};
  }();
  return p;
}

Eigen::Vector3d axis(const Pose& pose, int i) {
  return pose.q.toRotationMatrix().col(i);
}

TEST(MoveBlade, KeepsEveryLimitByIndependentDifferences) {
  const MotionSettings limits;
  const auto& poses = planned().motion.poses;
  for (const auto clamp : {&BladePose::a, &BladePose::b}) {
    for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
      const Pose &p = poses[i - 1].*clamp, &q = poses[i].*clamp, &r = poses[i + 1].*clamp;
      const double t0 = poses[i].t - poses[i - 1].t, t1 = poses[i + 1].t - poses[i].t;
      ASSERT_GT(t0, 0.004);
      ASSERT_LE(t0, 0.05 + 1e-6);
      EXPECT_LE((q.p - p.p).norm() / t0, limits.travel_mm_s);
      EXPECT_LE(((r.p - q.p) / t1 - (q.p - p.p) / t0).norm() / t1, limits.accel_mm_s2);
      EXPECT_LE(p.q.angularDistance(q.q) / t0, limits.angular_rad_s);
      EXPECT_LE(std::abs(q.q.angularDistance(r.q) / t1 - p.q.angularDistance(q.q) / t0) / t1,
                limits.angular_accel_rad_s2);
    }
  }
  EXPECT_TRUE(planned().motion.refusals.empty());
}

// What clamps do by differences of their poses alone, at rest before the first and after the last.
struct Differences {
  double jerk = 0, turn_jerk = 0;
};

Differences differences(const std::vector<BladePose>& poses) {
  Differences most;
  for (const auto clamp : {&BladePose::a, &BladePose::b}) {
    // Of the last three steps: their lengths, velocities, and changes of velocity.
    std::vector<double> step(3, poses[1].t - poses[0].t);
    std::vector<Eigen::Vector3d> v(2, Eigen::Vector3d::Zero()), w = v;
    Eigen::Vector3d a = Eigen::Vector3d::Zero(), turn_a = a;
    for (std::size_t i = 1; i < poses.size() + 2; ++i) {
      const BladePose &from = poses[std::min(i, poses.size()) - 1],
                      &to = poses[std::min(i, poses.size() - 1)];
      step = {step[1], step[2], i < poses.size() ? to.t - from.t : step[2]};
      const Eigen::AngleAxisd turn((to.*clamp).q() * (from.*clamp).q().conjugate());
      const double angle = turn.angle() > M_PI ? turn.angle() - 2 * M_PI : turn.angle();
      v = {v[1], ((to.*clamp).p - (from.*clamp).p) / step[2]};
      w = {w[1], angle * turn.axis() / step[2]};
      const Eigen::Vector3d now = (v[1] - v[0]) / ((step[1] + step[2]) / 2),
                            turn_now = (w[1] - w[0]) / ((step[1] + step[2]) / 2);
      const double third = (step[0] + step[1] + step[2]) / 3;
      most.jerk = std::max(most.jerk, (now - a).norm() / third);
      most.turn_jerk = std::max(most.turn_jerk, (turn_now - turn_a).norm() / third);
      a = now;
      turn_a = turn_now;
    }
  }
  return most;
}

// Jerk as a mid-size arm takes it, and less.
Settings with_jerk(double narrower) {
  Settings settings = along_x();
  settings.motion.jerk_mm_s3 = 5000 / narrower;
  settings.motion.angular_jerk_rad_s3 = 20 / narrower;
  return settings;
}

TEST(TimeLaw, KeepsJerkByIndependentDifferences) {
  for (const double step_s : {0.01, 0.05}) {
    for (const double narrower : {1.0, 5.0, 50.0}) {
      Settings settings = with_jerk(narrower);
      settings.motion.waypoint_s = step_s;
      const BladeMotion motion = move_blade(planned().strip, settings);
      EXPECT_TRUE(motion.refusals.empty());
      const Differences most = differences(motion.poses);
      EXPECT_LE(most.jerk, settings.motion.jerk_mm_s3);
      EXPECT_LE(most.turn_jerk, settings.motion.angular_jerk_rad_s3);
      EXPECT_GT(std::max(most.jerk / settings.motion.jerk_mm_s3,
                         most.turn_jerk / settings.motion.angular_jerk_rad_s3),
                0.5)
          << "slower than the limits ask for";
      std::printf("jerk %.0f mm/s3, %.0f ms: %.1f of %.0f, %.2f of %.2f rad/s3, %.2f of %.2f s added\n",
                  settings.motion.jerk_mm_s3, 1000 * step_s, most.jerk, settings.motion.jerk_mm_s3,
                  most.turn_jerk, settings.motion.angular_jerk_rad_s3, motion.facts.jerk_s,
                  motion.facts.duration_s);
    }
  }
}

TEST(TimeLaw, JerkCostsLittle) {
  const MotionFacts& without = planned().motion.facts;
  EXPECT_EQ(without.jerk_s, 0);
  const MotionFacts facts = move_blade(planned().strip, with_jerk(1)).facts;
  EXPECT_GT(facts.jerk_s, 0);
  EXPECT_NEAR(facts.duration_s, without.duration_s + facts.jerk_s, 1e-6);
  EXPECT_LE(facts.duration_s, 1.05 * without.duration_s);
}

TEST(TimeLaw, JerkIsNamedWhereItHoldsTheBladeBack) {
  Settings settings = along_x();
  settings.motion.jerk_mm_s3 = 0.1;
  settings.motion.min_feed_mm_s = 5;
  const auto slow = [&]() -> std::string {
    for (const Refusal& r : move_blade(planned().strip, settings).refusals)
      if (r.limit == Limit::kSlowestFeed) return r.note;
    return "";
  };
  const std::string note = slow(), key = "motion.jerk_mm_s3 of ";
  EXPECT_EQ(note.find("the clamps' limit of jerk holds the blade back there"), 0U) << note;
  // What it says would help, does.
  ASSERT_NE(note.find(key), std::string::npos) << note;
  settings.motion.jerk_mm_s3 = std::stod(note.substr(note.find(key) + key.size()));
  EXPECT_GT(settings.motion.jerk_mm_s3, 0.1);
  EXPECT_EQ(slow(), "");
}

TEST(TimeLaw, JerkChangesTimesAndNothingElse) {
  const BladeMotion slower = move_blade(planned().strip, with_jerk(10));
  const BladeMotion& before = planned().motion;
  ASSERT_EQ(slower.poses.size(), before.poses.size());
  for (std::size_t i = 0; i < before.poses.size(); ++i) {
    EXPECT_EQ(slower.poses[i].a.p, before.poses[i].a.p);
    EXPECT_EQ(slower.poses[i].b.q().coeffs(), before.poses[i].b.q().coeffs());
    EXPECT_EQ(slower.poses[i].rib, before.poses[i].rib);
  }
  EXPECT_GT(slower.facts.duration_s, before.facts.duration_s);
}

TEST(MoveBlade, ClampsSitOnTheBladesEndsWithItsTangents) {
  for (const BladePose& pose : planned().motion.poses) {
    const auto ends = elastica::sample(pose.blade, 2);
    for (const auto& [clamp, point] : {std::pair{pose.a, ends[0]}, std::pair{pose.b, ends[1]}}) {
      EXPECT_LT((clamp.p - pose.frame.point(point.x, point.y)).norm(), 1e-7);  // RoundPoses
      const Eigen::Vector3d tangent =
          std::cos(point.theta) * pose.frame.x() + std::sin(point.theta) * pose.frame.y();
      EXPECT_LT((axis(clamp, 0) - tangent).norm(), 1e-9);
      EXPECT_LT((axis(clamp, 2) - pose.frame.normal()).norm(), 1e-9);
    }
    EXPECT_EQ(pose.blade.length, planned().strip.blade_length_mm);
  }
}

TEST(MoveBlade, StartsAndEndsAtAFlatCircularArc) {
  for (const BladePose* pose : {&planned().motion.poses.front(), &planned().motion.poses.back()}) {
    const double l = pose->blade.length;
    const double half_turn = 0.5 * pose->blade.kappa * l;
    EXPECT_GE(std::abs(half_turn), 0.10);
    EXPECT_LE(std::abs(half_turn), 0.17);
    EXPECT_EQ(pose->blade.lambda1, 0);
    EXPECT_EQ(pose->blade.lambda2, 0);
    EXPECT_NEAR((pose->a.p - pose->b.p).norm(), l * std::sin(half_turn) / half_turn, 1e-6);
    EXPECT_FALSE(pose->heat);
  }
}

TEST(MoveBlade, RunsThroughThePhasesInOrderAndHeatsOnlyWhenNeeded) {
  std::vector<std::string> phases;
  for (const BladePose& pose : planned().motion.poses) {
    if (phases.empty() || phases.back() != name(pose.phase)) phases.emplace_back(name(pose.phase));
    const std::set<std::string> hot{"preheat", "approach", "lead_in", "cut", "lead_out"};
    EXPECT_EQ(pose.heat, hot.count(name(pose.phase)) > 0) << name(pose.phase);
    EXPECT_EQ(pose.foam.has_value(), pose.phase == StripPhase::kCut);
  }
  EXPECT_EQ(phases, (std::vector<std::string>{"form", "preheat", "approach", "lead_in", "cut", "lead_out",
                                              "retract", "travel"}));
}

TEST(MoveBlade, StaysOnOneStableBranch) {
  for (const BladePose& pose : planned().motion.poses) EXPECT_GT(pose.margin, 1);
  EXPECT_GT(planned().motion.facts.smallest_margin, 1);
}

TEST(MoveBlade, PassesThroughEveryRib) {
  std::set<int> ribs;
  for (const BladePose& pose : planned().motion.poses) {
    if (!pose.rib) continue;
    ribs.insert(*pose.rib);
    const RibFit& rib = planned().strip.ribs[static_cast<std::size_t>(*pose.rib)];
    const auto [s0, s1] = *pose.foam;
    const auto on_blade = elastica::point_at(pose.blade, 0.5 * (s0 + s1));
    EXPECT_LT(elastica::max_distance(std::vector{on_blade.position()}, rib.elastica), 0.05);
  }
  EXPECT_EQ(ribs.size(), planned().strip.ribs.size());
}

TEST(LayOutStrips, PutsTheBlockOnThePlinthAboveTheTableCentred) {
  const StripPlan& strip = planned().strip;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d size = strip.block.size_mm;
    const Eigen::Vector3d p = strip.block.frame.point(
        (corner & 1) ? size.x() : 0, (corner & 2) ? size.y() : 0, (corner & 4) ? size.z() : 0);
    const Pose cell = transformed(strip.design_to_cell, {p, Eigen::Quaterniond::Identity()});
    low = low.cwiseMin(cell.p);
    high = high.cwiseMax(cell.p);
  }
  EXPECT_NEAR(low.z(), 150, 1e-9);
  EXPECT_NEAR(low.x() + high.x(), 0, 1e-9);
  EXPECT_NEAR(low.y() + high.y(), 0, 1e-9);
  // The sweep runs downwards, so rib planes lie level.
  EXPECT_NEAR((strip.design_to_cell.q * strip.sweep).z(), -1, 1e-12);
}

double lowest_clamp_mm(const StripPlan& strip, const BladeMotion& motion) {
  double lowest = 1e9;
  for (const BladePose& pose : motion.poses)
    for (const PoseRow& clamp : {pose.a, pose.b})
      lowest = std::min(lowest, transformed(strip.design_to_cell, clamp).p.z());
  return lowest;
}

TEST(MoveBlade, RaisesTheBlockAsFarAsTheClampsNeedIt) {
  StripPlan low = planned().strip;
  low.design_to_cell.p.z() -= 130;
  const BladeMotion raised = move_blade(low, along_x());
  for (const Refusal& r : raised.refusals) ADD_FAILURE() << describe(r);
  const double lowest = lowest_clamp_mm(low, raised);
  ASSERT_LT(lowest, 40);
  EXPECT_GE(lowest + raised.raise_mm, 40);
  EXPECT_LT(lowest + raised.raise_mm, 50);
  EXPECT_EQ(std::fmod(raised.raise_mm, 10), 0);
  EXPECT_EQ(planned().motion.raise_mm, 0);
}

TEST(MoveBlade, RefusesClampsBelowTheTableOnAPlinthThatIsGiven) {
  StripPlan low = planned().strip;
  low.design_to_cell.p.z() -= 130;
  Settings given = along_x();
  given.machine.plinth_mm = 20;
  const BladeMotion motion = move_blade(low, given);
  EXPECT_EQ(motion.raise_mm, 0);
  ASSERT_EQ(motion.refusals.size(), 1U);
  EXPECT_EQ(motion.refusals.front().limit, Limit::kClampHeight);
}

}  // namespace
}  // namespace hotblade::pipeline
