#include "pipeline/verify/branch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "elastica/blade/continuation.hpp"
#include "pipeline/plan/motion/blade_path.hpp"
#include "pipeline/plan/plan.hpp"
#include "pipeline/program/clamps.hpp"
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

TEST(FollowBranch, FindsTheShapesOfAPlanFromItsClampsAlone) {
  const BranchReport report = follow_branch(cylinder_strip(), kSpring);
  EXPECT_EQ(report.limit, Limit::kNone);
  EXPECT_LT(report.mismatch_mm, 1e-4);
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
  Strip strip;
  strip.id = "S001";
  strip.blade_length_mm = 500;
  elastica::Elastica blade{0, 0, 0.13, -0.26 / 500, 0, 0, 500};
  strip.poses.push_back(pose_of(blade, 0));
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
