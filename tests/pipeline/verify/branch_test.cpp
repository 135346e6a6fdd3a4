#include "pipeline/verify/branch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "elastica/blade/continuation.hpp"
#include "elastica/blade/stability.hpp"
#include "pipeline/plan/motion/blade_path.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/program/clamps.hpp"
#include "robot/blade/blade_check.hpp"
#include "robot/wire/protocol.hpp"
#include "tests/pipeline/plan_design.hpp"

namespace hotblade::pipeline {
namespace {

const Strip& cylinder_strip() {
  static const Strip strip = plan(cylinder_design(), along_x(), {}).program.strips.at(0);
  return strip;
}

constexpr BranchOptions kSpring{1 / 70.5, 1};

BladePose pose_of(const elastica::Elastica& blade, double t) {
  BladePose pose;
  pose.t = t;
  pose.phase = StripPhase::kForm;
  pose.blade = blade;
  const ClampPoses pair = clamps(blade, pose.frame);
  pose.a = pair.a;
  pose.b = pair.b;
  return pose;
}

// A strip of a blade of 500 mm that begins flat.
Strip begun(const elastica::Elastica& flat) {
  Strip strip;
  strip.id = "S001";
  strip.blade_length_mm = flat.length;
  strip.poses.push_back(pose_of(flat, 0));
  return strip;
}
constexpr elastica::Elastica kFlat{0, 0, 0.13, -0.26 / 500, 0, 0, 500};

TEST(FollowBranch, FindsTheShapesOfAPlanFromItsClampsAlone) {
  const BranchReport report = follow_branch(cylinder_strip(), kSpring);
  EXPECT_EQ(report.limit, Limit::kNone);
  EXPECT_LT(report.mismatch_mm, 0.01);  // what a micrometre does to its shallow arcs
  EXPECT_GT(report.smallest_margin, 10);
  EXPECT_NEAR(1 / report.largest_curvature_per_mm, 400, 5);
  EXPECT_EQ(report.taut_poses, 0u);
}

TEST(FollowBranch, SeesABladeThatIsNotWhereTheProgramSays) {
  Strip strip = cylinder_strip();
  strip.poses[300].b.p += 0.5 * strip.poses[300].frame.x();
  const BranchReport report = follow_branch(strip, kSpring);
  EXPECT_EQ(report.limit, Limit::kPlannedShape);
  EXPECT_EQ(report.pose, 300u);
  // The end by half a millimetre, the belly of the shallow arc by more.
  EXPECT_GT(report.value, 0.4);
  EXPECT_LT(report.value, 2);
}

TEST(FollowBranch, SeesAClampOutOfThePlane) {
  Strip strip = cylinder_strip();
  strip.poses[200].b.p += 0.1 * strip.poses[200].frame.normal();
  const BranchReport report = follow_branch(strip, kSpring);
  EXPECT_EQ(report.limit, Limit::kBladePlane);
  EXPECT_EQ(report.pose, 200u);
  EXPECT_NEAR(report.value, 0.1, 1e-6);
}

TEST(FollowBranch, RefusesAStartThatIsNoFlatArc) {
  Strip strip = cylinder_strip();
  const auto formed = std::find_if(strip.poses.begin(), strip.poses.end(),
                                   [](const BladePose& p) { return p.phase == StripPhase::kPreheat; });
  strip.poses.erase(strip.poses.begin(), formed);
  EXPECT_EQ(follow_branch(strip, kSpring).limit, Limit::kStartPose);
  strip.poses.clear();
  EXPECT_EQ(follow_branch(strip, kSpring).limit, Limit::kStartPose);
}

TEST(FollowBranch, RefusesYieldAndASmallMarginWithTheirAmounts) {
  const BranchReport bent = follow_branch(cylinder_strip(), {1.0 / 500, 1});
  EXPECT_EQ(bent.limit, Limit::kBladeYield);
  EXPECT_LT(bent.value, 500);
  EXPECT_GE(bent.value, 395);
  EXPECT_DOUBLE_EQ(bent.bound, 500);
  const BranchReport loose = follow_branch(cylinder_strip(), {1 / 70.5, 100});
  EXPECT_EQ(loose.limit, Limit::kBladeMargin);
  EXPECT_LT(loose.value, 100);
  EXPECT_EQ(loose.bound, 100);
}

TEST(FollowBranch, SeesASnapBetweenWaypoints) {
  // An arch whose end tangents are turned down: it holds for a while, then snaps to the other side.
  Strip strip = begun(kFlat);
  elastica::Elastica blade = kFlat;
  const elastica::ClampPair arc = elastica::clamps_of(blade);
  std::size_t held = 0;
  for (int i = 1; i <= 120; ++i) {
    const double closing = std::min(1.0, i / 40.0), turn = std::max(0.0, (i - 40) / 80.0);
    elastica::ClampPair to = arc;
    to.b.x = arc.b.x - 60 * closing;
    to.a.theta = arc.a.theta - 1.4 * turn;
    to.b.theta = arc.b.theta + 1.4 * turn;
    const elastica::FollowReport way = elastica::follow(blade, to);
    if (way.status == elastica::FollowStatus::kFollowed) {
      blade = way.shape.elastica;
      held = static_cast<std::size_t>(i);
      strip.poses.push_back(pose_of(blade, i));
    } else {
      // The clamps go on; what the program claims of the blade no longer matters.
      BladePose lost = pose_of({to.a.x, to.a.y, to.a.theta, 0, 0, 0, 500}, i);
      lost.b = pose_of({to.b.x, to.b.y, to.b.theta, 0, 0, 0, 500}, i).a;
      strip.poses.push_back(lost);
      break;
    }
  }
  ASSERT_GT(held, 45u);
  ASSERT_LT(held, 120u);
  const BranchReport report = follow_branch(strip, {1 / 30.0, 0});
  EXPECT_EQ(report.limit, Limit::kBladeSnap);
  EXPECT_EQ(report.pose, held + 1);
  const std::string text = describe(branch_refusal(strip, report));
  EXPECT_NE(text.find("snaps through"), std::string::npos) << text;
}

// A blade of 500 mm is let out until its chord is shorter by `slack_mm`; then both ends are turned one way,
// which makes an S of the arc, until its margin is `margin` and the arc is about to snap.
Strip pressed_strip(double slack_mm, double margin, double turn_rad) {
  Strip strip = begun(kFlat);
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  strip.design_to_cell.q =
      Eigen::Quaterniond(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d(s, c, 1).normalized()));
  strip.design_to_cell.p = {100 * c, 77 * s, 300 + c};
  elastica::Elastica blade = kFlat;
  const elastica::ClampPair arc = elastica::clamps_of(blade);
  elastica::ClampPair to = arc;
  const auto go = [&] {
    const elastica::FollowReport way = elastica::follow(blade, to);
    if (way.status != elastica::FollowStatus::kFollowed) return false;
    if (elastica::stability_margin(way.shape.elastica) < margin) return false;
    blade = way.shape.elastica;
    strip.poses.push_back(pose_of(blade, static_cast<double>(strip.poses.size())));
    return true;
  };
  constexpr int kSteps = 40;
  for (int i = 1; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    to.a.theta = (1 - share) * arc.a.theta;
    to.b.theta = (1 - share) * arc.b.theta;
    to.b.x = arc.b.x + share * (500 - slack_mm - arc.b.x);
    EXPECT_TRUE(go());
  }
  for (double step = 1e-3; step > 1e-9;) {
    const elastica::ClampPair before = to;
    to.a.theta += step;
    to.b.theta += step;
    if (go()) continue;
    to = before;
    step /= 4;
  }
  return strip;
}

// What the controller says first of the strip's clamps, as they are or as its registers hold them; or what it
// would say if it looked at waypoints alone.
robot::Limit as_checked(const Strip& strip, const BranchOptions& options, bool by_registers,
                        bool halfway = true) {
  const robot::ClampedBlade section{{20, 0.5, 200000, 200000 * options.max_curvature_per_mm * 0.25}, 500};
  robot::BladeCheck check(section, {true, 1, options.min_margin, options.offsets});
  for (robot::Waypoint waypoint : waypoints(strip)) {
    if (by_registers)
      waypoint = robot::protocol::decode_waypoint(*robot::protocol::encode_waypoint(waypoint)).waypoint;
    const robot::Limit limit = halfway ? check.next(waypoint) : check.move_to({waypoint.a, waypoint.b});
    if (limit != robot::Limit::kNone) return limit;
  }
  return robot::Limit::kNone;
}

TEST(FollowBranch, JudgesPressedBladesByTheMicrometresThatAControllerIsTold) {
  const BranchOptions options{1 / 30.0, 1};
  std::mt19937 random(24);
  std::uniform_real_distribution<double> unit(0, 1);
  int refused_by_micrometres = 0, held = 0;
  for (int i = 0; i < 60; ++i) {
    const double slack = 0.02 * std::pow(50, unit(random)), margin = 1 + std::pow(unit(random), 3);
    const Strip strip = pressed_strip(slack, margin, 6 * unit(random));
    const BranchReport report = follow_branch(strip, options);
    const robot::Limit told = as_checked(strip, options, true);
    EXPECT_EQ(report.limit, told) << slack << " mm of slack, margin " << margin;
    refused_by_micrometres += !report.held() && as_checked(strip, options, false) == robot::Limit::kNone;
    held += report.held();
  }
  EXPECT_GE(refused_by_micrometres, 5);
  EXPECT_GE(held, 10);
}

// An arch whose clamps are then turned about its middle all at once: between two such waypoints they come
// closer, as each moves along a straight line.
Strip turned_arch(double turn_rad) {
  Strip strip = begun(kFlat);
  elastica::Elastica blade = kFlat;
  const elastica::ClampPair arc = elastica::clamps_of(blade);
  constexpr int kSteps = 40;
  for (int i = 1; i <= kSteps; ++i) {
    elastica::ClampPair to = arc;
    to.b.x -= 60.0 * i / kSteps;
    const elastica::FollowReport way = elastica::follow(blade, to);
    EXPECT_EQ(way.status, elastica::FollowStatus::kFollowed) << i;
    blade = way.shape.elastica;
    strip.poses.push_back(pose_of(blade, i));
  }
  const elastica::PlanarPose end = elastica::clamps_of(blade).b;
  const Eigen::Vector2d a(blade.x, blade.y), middle = 0.5 * (a + Eigen::Vector2d(end.x, end.y));
  const Eigen::Vector2d turned = middle + Eigen::Rotation2Dd(turn_rad) * (a - middle);
  const Eigen::Vector2d force = Eigen::Rotation2Dd(turn_rad) * Eigen::Vector2d(blade.lambda1, blade.lambda2);
  blade = {turned.x(), turned.y(), blade.theta + turn_rad, blade.kappa, force.x(), force.y(), blade.length};
  strip.poses.push_back(pose_of(blade, kSteps + 1));
  return strip;
}

TEST(FollowBranch, LooksAtThePoseHalfwayBetweenTwoWaypointsWhereTheBladeIsNearALimit) {
  int refused_between = 0, held = 0;
  for (const double turn : {0.01, 0.03, 0.1, 0.2}) {
    const Strip strip = turned_arch(turn);
    const double peak = elastica::ElasticaCurve(strip.poses.back().blade).max_abs_curvature();
    for (const double over : {1.0005, 1.002, 1.01, 1.05, 1.5}) {
      const BranchOptions options{over * peak, 1};
      const BranchReport report = follow_branch(strip, options);
      EXPECT_EQ(report.limit, as_checked(strip, options, true)) << turn << " rad, " << over;
      held += report.held();
      if (report.held() || as_checked(strip, options, true, false) != robot::Limit::kNone) continue;
      ++refused_between;
      EXPECT_EQ(report.limit, Limit::kBladeYield);
      EXPECT_EQ(report.pose, strip.poses.size() - 1);
      EXPECT_LT(report.value, report.bound);
    }
  }
  EXPECT_GE(refused_between, 4);
  EXPECT_GE(held, 4);
}

TEST(FollowBranch, AMicrometreThatMovesANearlyStraightBladeIsNoOtherShape) {
  // 0.01 mm of slack: a thousandth more or less moves the bow by a twentieth of its 1.4 mm.
  const Strip strip = pressed_strip(0.01, 8, 1);
  const BranchReport report = follow_branch(strip, {1 / 30.0, 1});
  EXPECT_EQ(report.limit, Limit::kNone);
  EXPECT_GT(report.mismatch_mm, kShapeMismatchMm);
  EXPECT_LT(report.mismatch_mm, 0.2);
  Strip other = strip;
  for (BladePose& pose : other.poses) {
    if (&pose - other.poses.data() > 50) pose.blade.kappa *= 1.2;
  }
  EXPECT_EQ(follow_branch(other, {1 / 30.0, 1}).limit, Limit::kPlannedShape);
}

TEST(FollowBranch, SaysByHowMuchMicrometresMoveWhatFormsTheDesignAcrossTheBlade) {
  // A micrometre of slack bows the blade by 0.4 mm, and registers cannot tell it from a straight one.
  Strip strip = pressed_strip(1e-3, 20, 2);
  EXPECT_EQ(follow_branch(strip, {1 / 30.0, 1}).told_off_mm, 0) << "nothing forms the design";
  strip.poses.back().foam = {{100, 400}};
  const BranchReport all = follow_branch(strip, {1 / 30.0, 1});
  EXPECT_EQ(all.limit, Limit::kNone);
  EXPECT_GT(all.told_off_mm, 0.1);
  EXPECT_LT(all.told_off_mm, 0.6);
  // Beside the clamps it moves by less.
  strip.poses.back().foam = {{1, 20}};
  EXPECT_LT(follow_branch(strip, {1 / 30.0, 1}).told_off_mm, 0.3 * all.told_off_mm);
  EXPECT_LT(follow_branch(cylinder_strip(), kSpring).told_off_mm, 0.005);
}

TEST(FollowBranch, KnowsTheSideOfABladeThatRegistersCannotTellFromAStraightOne) {
  // A micrometre of slack is 0.4 mm of bow.
  const Strip strip = pressed_strip(1e-3, 20, 2);
  const BranchReport report = follow_branch(strip, {1 / 30.0, 1});
  EXPECT_EQ(report.limit, Limit::kNone);
  EXPECT_EQ(report.taut_poses, 0u);
  Strip other = strip;
  BladePose& last = other.poses.back();
  last.blade.kappa = -last.blade.kappa;
  last.blade.theta = -last.blade.theta;
  last.blade.lambda2 = -last.blade.lambda2;
  const BranchReport mirrored = follow_branch(other, {1 / 30.0, 1});
  EXPECT_EQ(mirrored.limit, Limit::kPlannedShape);
  EXPECT_EQ(mirrored.pose, other.poses.size() - 1);
}

TEST(FollowBranch, KnowsTheSideOnWhichABladeLeavesTheStraightLine) {
  // Pressed again from a micrometre of slack, registers pick either side: the clamps as computed keep theirs.
  for (int i = 0; i < 12; ++i) {
    Strip strip = pressed_strip(1e-3, 20, 0.5 * i);
    elastica::Elastica blade = strip.poses.back().blade;
    elastica::ClampPair to = elastica::clamps_of(blade);
    constexpr int kSteps = 30;
    for (int k = 1; k <= kSteps; ++k) {
      to.b.x -= 1.0 / kSteps * std::cos(to.a.theta);
      to.b.y -= 1.0 / kSteps * std::sin(to.a.theta);
      const elastica::FollowReport way = elastica::follow(blade, to);
      ASSERT_EQ(way.status, elastica::FollowStatus::kFollowed) << i << " step " << k;
      blade = way.shape.elastica;
      strip.poses.push_back(pose_of(blade, static_cast<double>(strip.poses.size())));
    }
    EXPECT_EQ(follow_branch(strip, {1 / 30.0, 1}).limit, Limit::kNone) << i;
  }
}

TEST(BranchRefusal, NamesStripRibPhaseAndTime) {
  Strip strip = cylinder_strip();
  std::size_t cut = 0;
  while (!strip.poses[cut].rib || *strip.poses[cut].rib != 3) ++cut;
  strip.poses[cut].b.p += 0.5 * strip.poses[cut].frame.x();
  const Refusal refusal = branch_refusal(strip, follow_branch(strip, kSpring));
  EXPECT_EQ(refusal.strip, "S001");
  EXPECT_EQ(refusal.rib, "S001R004");
  EXPECT_NE(refusal.when.find("phase cut"), std::string::npos) << refusal.when;
}

}  // namespace
}  // namespace hotblade::pipeline
