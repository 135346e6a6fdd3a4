// Two arms for a program: joints that hold the clamps, and refusals by name and amount.
#include "pipeline/plan/arms/arms.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "elastica/curve/elastica.hpp"
#include "pipeline/cell/cell_file.hpp"
#include "pipeline/plan/arms/check_joints.hpp"
#include "pipeline/plan/arms/strip_arms.hpp"
#include "pipeline/plan/motion/slower.hpp"
#include "pipeline/program/program_text.hpp"
#include "pipeline/program/straight_start.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Program envelope_for(Program program) {
  program.settings.machine.envelope_mm = {4000, 4000, 3000};
  return program;
}

// The vault at a tenth of its speed, which starts and ends abruptly.
Program slow_vault() {
  Program program = envelope_for(testing::vault_program());
  for (Strip& strip : program.strips) {
    for (BladePose& pose : strip.poses) pose.t *= 10;
  }
  return program;
}

// The vault where the arms of a cell are clear of everything.
Program clear_vault(const robot::Cell& cell) {
  Program program = slow_vault();
  const ArmedProgram armed = with_arms(program, cell);
  EXPECT_THAT(armed.report.refusals, IsEmpty());
  for (std::size_t i = 0; i < program.strips.size(); ++i)
    program.strips[i].design_to_cell = armed.program.strips[i].design_to_cell;
  return program;
}

robot::Cell cell_named(const std::string& name) {
  robot::Cell cell = read_cell(name);
  cell.place.raise_mm = {0, 400};
  return cell;
}

Isometry3d isometry(const Pose& pose) {
  Isometry3d place = Isometry3d::Identity();
  place.linear() = pose.q.toRotationMatrix();
  place.translation() = pose.p;
  return place;
}

const robot::CellArm& arm_of(const robot::Cell& cell, const std::string& id) {
  return cell.arms[0].id == id ? cell.arms[0] : cell.arms[1];
}

TEST(WithArms, JointsHoldTheClamps) {
  for (const char* name : {"two_irb4600", "two_kr50"}) {
    const robot::Cell cell = cell_named(name);
    const ArmedProgram armed = with_arms(slow_vault(), cell);
    ASSERT_THAT(armed.report.refusals, IsEmpty()) << name << ": " << describe(armed.report.refusals.front());
    ASSERT_TRUE(armed.program.cell);
    for (const Strip& strip : armed.program.strips) {
      ASSERT_EQ(strip.joints.size(), strip.poses.size());
      for (std::size_t k = 0; k < strip.poses.size(); ++k) {
        const BladePose& pose = strip.poses[k];
        for (const bool b : {false, true}) {
          const HeldClamp& held = b ? strip.arms->b : strip.arms->a;
          const robot::CellArm& arm = arm_of(cell, held.arm);
          const ArmJoints& joints = b ? strip.joints[k].b : strip.joints[k].a;
          const robot::JointAngles q = Eigen::Map<const robot::JointAngles>(joints.data());
          const Isometry3d jaw =
              isometry(arm.base) * robot::forward(arm.model.arm, q) * robot::jaw_in_flange(arm.tool);
          const Isometry3d clamp = isometry(strip.design_to_cell) * isometry(b ? pose.b : pose.a);
          EXPECT_LE((jaw.translation() - clamp.translation()).norm(), 1e-6);
          // The blade leaves the jaw: at A the way to B, at B the way back.
          EXPECT_LE((jaw.linear().col(0) - (b ? -1 : 1) * clamp.linear().col(0)).norm(), 1e-9);
          EXPECT_LE((jaw.linear().col(2) - (held.flip ? -1 : 1) * clamp.linear().col(2)).norm(), 1e-9);
        }
      }
    }
  }
}

TEST(WithArms, TakesTheLeastHeightThatIsGood) {
  robot::Cell cell = cell_named("two_irb4600");
  const Program program = slow_vault();
  const ArmedProgram armed = with_arms(program, cell);
  ASSERT_THAT(armed.report.refusals, IsEmpty());
  const double raise = armed.program.strips[0].arms->raise_mm;
  EXPECT_EQ(armed.program.strips[0].design_to_cell.p.z(), program.strips[0].design_to_cell.p.z() + raise);
  for (double lower = 0; lower < raise; lower += 100)
    EXPECT_LT(PlaceScorer(program.strips[0], cell)({lower, false}), 1) << "a lower place was as good";
  EXPECT_FALSE(armed.program.strips[0].arms->nearest_mm.empty());
  const Program clear = clear_vault(cell);
  cell.place.how = robot::Placing::kFixed;
  const ArmedProgram fixed = with_arms(clear, cell);
  ASSERT_THAT(fixed.report.refusals, IsEmpty());
  EXPECT_EQ(fixed.program.strips[0].arms->raise_mm, 0);
  cell.place.how = robot::Placing::kRaise;
  cell.place.raise_mm = {raise + 100, raise + 100};
  EXPECT_EQ(with_arms(program, cell).program.strips[0].arms->raise_mm, raise + 100);
}

// What is scored at once is what path and margins say one after the other, with jaws on axis 6 and off it.
TEST(PlaceScorer, SaysWhatTheBranchesSay) {
  const Program program = envelope_for(testing::vault_program({.poses = 400}));
  const Strip& strip = program.strips[0];
  std::mt19937_64 random(3);
  const auto any = [&](double low, double high) { return std::uniform_real_distribution(low, high)(random); };
  std::size_t served = 0;
  for (const char* name : {"two_irb4600", "two_kr50"}) {
    robot::Cell cell = cell_named(name);
    for (int trial = 0; trial < 60; ++trial) {
      cell.arms[1].tool.jaw_p_mm = {trial % 2 == 0 ? 0.0 : 80.0, 0, 250};
      cell.arms[0].tool.flip = trial % 3 != 0;
      const ArmPlace place{any(0, 400), trial % 4 == 0, any(-300, 300), any(-300, 300), any(-0.5, 0.5)};
      double slow = 10;
      for (const bool clamp_b : {false, true}) {
        const robot::CellArm& arm = cell.arms[clamp_b != place.swapped ? 1 : 0];
        double best = -1;
        for (const bool flip : {false, true}) {
          if (flip && !arm.tool.flip) continue;
          const Hold hold = hold_of(arm, placed(strip.design_to_cell, place), clamp_b, flip);
          std::vector<Isometry3d> path;
          for (std::size_t k = 0; k < strip.poses.size(); k += 150)
            path.push_back(hold.flange(clamp_b ? strip.poses[k].b : strip.poses[k].a));
          path.push_back(hold.flange(clamp_b ? strip.poses.back().b : strip.poses.back().a));
          for (const robot::BranchPath& branch : robot::follow_branches(arm.model.arm, path)) {
            if (branch.size() < path.size()) continue;
            robot::BranchPath turned;
            const robot::Turns turns = robot::fit_turns(arm.model.arm, branch);
            for (const robot::JointAngles& q : branch) turned.push_back(robot::with_turns(q, turns));
            const robot::PathMargins m = robot::path_margins(arm.model.arm, turned);
            best = std::max(best, share_of_good(m.joint_rad.value, m.wrist_rad.value, m.elbow_rad.value,
                                                m.shoulder_mm.value));
          }
        }
        slow = std::min(slow, best);
      }
      const double fast = PlaceScorer(strip, cell)(place);
      if (slow > 0) {
        EXPECT_NEAR(fast, slow, 1e-9) << name << " " << trial;
        ++served;
      } else {
        EXPECT_LE(fast, 0) << name << " " << trial;
      }
    }
  }
  EXPECT_GT(served, 40u);
}

// Slow arms make a program slower; other arms begin with the clamps' own times again.
TEST(WithArms, TimesOfFormerArmsAreForgotten) {
  const robot::Cell quick = cell_named("two_irb4600");
  robot::Cell slow = quick;
  for (robot::CellArm& arm : slow.arms) {
    arm.acceleration_rad_s2.fill(0.01);
    arm.jerk_rad_s3.fill(0.03);
  }
  const Program program = clear_vault(quick);
  const ArmedProgram late = with_arms(program, slow);
  ASSERT_THAT(late.report.refusals, IsEmpty()) << describe(late.report.refusals.front());
  const Strip& strip = late.program.strips[0];
  ASSERT_GT(strip.poses.back().t, program.strips[0].poses.back().t + 0.5);
  ASSERT_THAT(strip.arms->clamp_times_s, SizeIs(strip.poses.size()));
  // Through a file, as a user does it.
  const Program read = parse_program(to_json(late.program), "late.json");
  EXPECT_EQ(read.strips[0].arms->clamp_times_s, strip.arms->clamp_times_s);
  EXPECT_EQ(to_json(with_arms(read, quick).program), to_json(with_arms(program, quick).program));
  Program broken = late.program;
  broken.strips[0].arms->clamp_times_s.pop_back();
  EXPECT_THROW((void)parse_program(to_json(broken), "broken.json"), Error);
}

TEST(WithArms, SearchesWhereHeightsDoNotServe) {
  robot::Cell cell = cell_named("two_irb4600");
  // A wall where an arm would be.
  robot::Obstacle fence{"fence", {}, {Isometry3d::Identity(), robot::Box{{50, 300, 2000}}}};
  fence.at.p = {-800, 0, 1000};
  cell.obstacles.push_back(fence);
  const Program program = slow_vault();
  cell.place.how = robot::Placing::kRaise;
  ASSERT_THAT(with_arms(program, cell).report.refusals, SizeIs(1));
  cell.place.how = robot::Placing::kSearch;
  const ArmedProgram armed = with_arms(program, cell);
  ASSERT_THAT(armed.report.refusals, IsEmpty()) << describe(armed.report.refusals.front());
  const StripArms& arms = *armed.program.strips[0].arms;
  EXPECT_GT(std::abs(arms.dx_mm) + std::abs(arms.dy_mm) + std::abs(arms.yaw_rad), 0);
  EXPECT_THAT(check_joints(armed.program, cell).breaches, IsEmpty());
  EXPECT_THAT(describe_arms(armed.program), HasSubstr("raised "));
  // What was moved is put back before arms are looked for again.
  EXPECT_EQ(with_arms(armed.program, cell).program.strips[0].arms->yaw_rad, arms.yaw_rad);
  const Pose &before = program.strips[0].design_to_cell, &now = armed.program.strips[0].design_to_cell;
  const Pose back = unplaced(now, {arms.raise_mm, false, arms.dx_mm, arms.dy_mm, arms.yaw_rad});
  EXPECT_LE((back.p - before.p).norm(), 1e-9);
  EXPECT_LE(back.q.angularDistance(before.q), 1e-12);
}

TEST(WithArms, SaysTheMarginsThatAreThere) {
  const robot::Cell cell = cell_named("two_kr50");
  const ArmedProgram armed = with_arms(slow_vault(), cell);
  ASSERT_THAT(armed.report.refusals, IsEmpty());
  const Strip& strip = armed.program.strips[0];
  double least = 10;
  for (const ClampJoints& joints : strip.joints) {
    for (const bool b : {false, true}) {
      const robot::Arm& arm = arm_of(cell, (b ? strip.arms->b : strip.arms->a).arm).model.arm;
      for (std::size_t i = 0; i < kArmJoints; ++i) {
        const double q = b ? joints.b[i] : joints.a[i];
        least = std::min({least, q - arm.joints()[i].min_rad, arm.joints()[i].max_rad - q});
      }
    }
  }
  EXPECT_NEAR(strip.arms->joint_margin_rad.value, least, 1e-10);
  ASSERT_TRUE(strip.arms->reach);
  EXPECT_GT(strip.arms->reach->value, 0.3);
  EXPECT_LT(strip.arms->reach->value, 1);
  EXPECT_GE(least, cell.margins.joint_deg * robot::kDegree_rad);
}

std::string refusal_in(const robot::Cell& cell, const Program& program, Limit limit) {
  const ArmedProgram armed = with_arms(program, cell);
  if (armed.report.refusals.size() != 1) return "refusals: " + std::to_string(armed.report.refusals.size());
  EXPECT_FALSE(armed.program.cell) << "a refused program has no joints";
  EXPECT_TRUE(armed.program.strips[0].joints.empty());
  const Refusal& refusal = armed.report.refusals[0];
  EXPECT_EQ(static_cast<int>(refusal.limit), static_cast<int>(limit)) << describe(refusal);
  return describe(refusal);
}

TEST(WithArms, RefusesAnArmThatStandsTooFarOff) {
  robot::Cell cell = cell_named("two_irb4600");
  cell.arms[1].base.p.x() += 1500;
  const std::string said = refusal_in(cell, slow_vault(), Limit::kArmReach);
  EXPECT_THAT(said, HasSubstr("S001: distance of an arm's wrist from its shoulder"));
  EXPECT_THAT(said, HasSubstr("(limit 2377 mm) in phase"));
  EXPECT_THAT(said, HasSubstr("arm R2 cannot reach clamp"));
  EXPECT_THAT(said, HasSubstr("of 10 choices of place and arms 10 are out of reach"));
}

TEST(WithArms, RefusesAFenceInTheWayByName) {
  robot::Cell cell = cell_named("two_irb4600");
  ASSERT_THAT(with_arms(slow_vault(), cell).report.refusals, IsEmpty());
  robot::Obstacle fence{"fence", {}, {Isometry3d::Identity(), robot::Box{{50, 4000, 2000}}}};
  fence.at.p = {-1300, 0, 1000};
  cell.obstacles.push_back(fence);
  const std::string said = refusal_in(cell, slow_vault(), Limit::kArmClearance);
  EXPECT_THAT(said, HasSubstr("S001: clearance in the cell 0 mm (limit 20 mm) in phase"));
  EXPECT_THAT(said, HasSubstr("from fence, 20 at least (20.0 mm too near)"));
  EXPECT_THAT(
      said,
      HasSubstr("5 are out of reach, 0 at joint limits, 0 next to singular, 5 not clear, 0 too slow a cut"));
}

// A block where only the tool that brings the straight blade comes: the strip itself is clear of it.
TEST(WithArms, RefusesWhatStandsInTheWayOfTheStraightBlade) {
  robot::Cell cell = cell_named("two_irb4600");
  const Program program = clear_vault(cell);
  cell.place.how = robot::Placing::kFixed;
  ASSERT_THAT(with_arms(program, cell).report.refusals, IsEmpty());
  const Strip& strip = program.strips[0];
  const std::vector<BladePose> start = straight_start(strip);
  ASSERT_EQ(start.size(), static_cast<std::size_t>(kStartMoves) + 1);
  // Straight, and bent to the first pose without a jump.
  EXPECT_EQ(start.front().blade.kappa, 0);
  EXPECT_NEAR((start.front().b.p - start.front().a.p).norm(), strip.blade_length_mm, 1e-9);
  EXPECT_LE((start.back().a.p - strip.poses.front().a.p).norm(), 1e-9);
  EXPECT_LE((start[start.size() - 2].a.p - strip.poses.front().a.p).norm(), 1);
  const Pose held = robot::transformed(strip.design_to_cell, start.front().a);
  robot::Obstacle post{"post", {}, {Isometry3d::Identity(), robot::Box{{30, 30, 30}}}};
  post.at.p = held.p - 150 * (held.q * Vector3d::UnitX());
  cell.obstacles.push_back(post);
  const std::string said = refusal_in(cell, program, Limit::kArmClearance);
  EXPECT_THAT(said, HasSubstr(" before the strip begins: arm R"));
  EXPECT_THAT(said, HasSubstr("tool is 0.0 mm from post"));
  EXPECT_THAT(said, HasSubstr("where the straight blade is bent to the strip's first shape"));
}

robot::Obstacle box_at(const std::string& id, const Vector3d& at, const Vector3d& size) {
  robot::Obstacle box{id, {}, {Isometry3d::Identity(), robot::Box{size}}};
  box.at.p = at;
  return box;
}

// A pin beside the block where no arm comes, but the blade does.
TEST(WithArms, RefusesWhatStandsInTheBladesWayByName) {
  robot::Cell cell = cell_named("two_irb4600");
  const Program program = clear_vault(cell);
  cell.place.how = robot::Placing::kFixed;
  Program armed = with_arms(program, cell).program;
  ASSERT_TRUE(armed.cell);
  EXPECT_THAT(describe_arms(armed), HasSubstr("blade to table"));
  const Strip& strip = program.strips[0];
  const BladePose& first = strip.poses.front();
  const elastica::CurvePoint middle = elastica::ElasticaCurve(first.blade).at(strip.blade_length_mm / 2);
  const Pose at = robot::transformed(strip.design_to_cell, {first.frame.point(middle.x, middle.y), {}});
  cell.obstacles.push_back(box_at("pin", at.p, {4, 4, 40}));
  EXPECT_THAT(refusal_in(cell, program, Limit::kArmClearance),
              HasSubstr("the blade is 0.0 mm from pin, 20.4"));
  // A program of this cell that was not held against the pin.
  armed.cell->sha256 = cell_sha256(cell);
  EXPECT_THAT(check_joints(armed, cell).breaches,
              ::testing::Contains(HasSubstr("the blade is 0.0 mm from pin")));
}

TEST(WithArms, RefusesABlockInAnObstacleAndASearchMovesItAway) {
  robot::Cell cell = cell_named("two_irb4600");
  const Program program = clear_vault(cell);
  const Strip& strip = program.strips[0];
  // Within the block, deep below the cut.
  const Vector3d low = strip.block.frame.origin + Vector3d(strip.block.size_mm.x() / 2, 125, 20);
  const Pose at = robot::transformed(strip.design_to_cell, {low, {}});
  cell.obstacles.push_back(box_at("stump", at.p, {20, 20, 20}));
  cell.place.how = robot::Placing::kFixed;
  EXPECT_THAT(refusal_in(cell, program, Limit::kArmClearance),
              HasSubstr("the block is 0.0 mm from stump, 20 at least (20.0 mm too near): another place"));
  cell.place.how = robot::Placing::kSearch;
  const ArmedProgram moved = with_arms(program, cell);
  ASSERT_THAT(moved.report.refusals, IsEmpty());
  const StripArms& arms = *moved.program.strips[0].arms;
  EXPECT_GT(std::abs(arms.dx_mm) + std::abs(arms.dy_mm), 0);
  EXPECT_THAT(check_joints(moved.program, cell).breaches, IsEmpty());
  const auto block = std::find_if(arms.nearest_mm.begin(), arms.nearest_mm.end(),
                                  [](const auto& pair) { return pair.kind == "block_obstacle"; });
  ASSERT_NE(block, arms.nearest_mm.end());
  EXPECT_GE(block->mm, cell.clearances.others_mm);
}

TEST(WithArms, RefusesALimitJustBelowNeed) {
  robot::Cell cell = cell_named("two_irb4600");
  const Program program = clear_vault(cell);
  cell.place.how = robot::Placing::kFixed;
  const ArmedProgram free = with_arms(program, cell);
  ASSERT_THAT(free.report.refusals, IsEmpty());
  // The range that each arm's joint 5 has to have, less a hundredth of a degree, with what is kept.
  const double kept = cell.margins.joint_deg * robot::kDegree_rad;
  for (robot::CellArm& arm : cell.arms) {
    robot::JointAngles least, most;
    for (std::size_t i = 0; i < robot::kJoints; ++i) {
      least[static_cast<int>(i)] = arm.model.arm.joints()[i].min_rad;
      most[static_cast<int>(i)] = arm.model.arm.joints()[i].max_rad;
    }
    double reached = 0;
    const bool b = free.program.strips[0].arms->b.arm == arm.id;
    for (const ClampJoints& joints : free.program.strips[0].joints)
      reached = std::max(reached, std::abs((b ? joints.b : joints.a)[4]));
    // Both signs, so that the other way of the wrist does not serve either.
    most[4] = reached + kept - 0.01 * robot::kDegree_rad;
    least[4] = -most[4];
    arm.model.arm = arm.model.arm.with_limits(least, most);
  }
  const std::string said = refusal_in(cell, program, Limit::kJointAngle);
  EXPECT_THAT(said, HasSubstr("joint_5, limit"));
  EXPECT_THAT(said, HasSubstr("of which 3 are kept (0.01 over)"));
}

TEST(WithArms, RefusesWhatIsNextToSingular) {
  robot::Cell cell = cell_named("two_kr50");
  cell.margins.wrist_deg = 89;
  const ArmedProgram armed = with_arms(slow_vault(), cell);
  ASSERT_THAT(armed.report.refusals, SizeIs(1));
  EXPECT_THAT(describe(armed.report.refusals[0]), HasSubstr("is next to singular"));
}

// The vault as it is starts and ends abruptly.
TEST(WithArms, MeetsWaypointsLaterForJoints) {
  for (const char* name : {"two_irb4600", "two_kr50"}) {
    const robot::Cell cell = cell_named(name);
    const Program program = testing::vault_program();
    const ArmedProgram armed = with_arms(envelope_for(program), cell);
    ASSERT_THAT(armed.report.refusals, IsEmpty()) << describe(armed.report.refusals.front());
    const Strip &with = armed.program.strips[0], &without = program.strips[0];
    ASSERT_EQ(with.poses.size(), without.poses.size());
    for (std::size_t i = 1; i < with.poses.size(); ++i) {
      EXPECT_EQ(with.poses[i].a.p, without.poses[i].a.p) << "the cut is the same";
      EXPECT_GE(with.poses[i].t - with.poses[i - 1].t, without.poses[i].t - without.poses[i - 1].t - 1e-9);
    }
    EXPECT_NEAR(with.arms->joints_s + with.arms->jerk_s, with.poses.back().t - without.poses.back().t, 1e-9);
    EXPECT_GT(with.arms->jerk_s, 0);
    const JointCheck check = check_joints(armed.program, cell);
    EXPECT_THAT(check.breaches, IsEmpty());
    EXPECT_LE(check.acceleration_share, 1);
    EXPECT_LE(check.jerk_share, 1);
    double most = std::max({check.speed_share, check.acceleration_share, check.jerk_share});
    std::vector<double> t;
    for (const BladePose& pose : with.poses) t.push_back(pose.t);
    for (const LimitedWay& clamp : moving_clamps(with.poses, program.settings.motion)) {
      for (const Use& use : uses(t, clamp)) most = std::max(most, use.most());
    }
    EXPECT_GT(most, 0.5) << "slower than joints and clamps ask for";
  }
}

TEST(WithArms, SlowerJointsTakeLonger) {
  robot::Cell cell = cell_named("two_irb4600");
  const double usual_s = with_arms(slow_vault(), cell).program.strips[0].poses.back().t;
  for (robot::CellArm& arm : cell.arms) arm.speed_share = 0.002;
  Program program = slow_vault();
  program.settings.motion.min_feed_mm_s = 0.01;
  const ArmedProgram armed = with_arms(program, cell);
  ASSERT_THAT(armed.report.refusals, IsEmpty()) << describe(armed.report.refusals.front());
  EXPECT_GT(armed.program.strips[0].poses.back().t, 1.2 * usual_s);
  EXPECT_GT(armed.program.strips[0].arms->joints_s, 0.2 * usual_s);
  EXPECT_THAT(check_joints(armed.program, cell).breaches, IsEmpty());
}

TEST(WithArms, RefusesAJointThatSlowsTheCutTooMuch) {
  robot::Cell cell = cell_named("two_irb4600");
  for (robot::CellArm& arm : cell.arms) arm.speed_share = 0.0002;
  Program program = slow_vault();
  program.settings.motion.min_feed_mm_s = 1;
  const std::string said = refusal_in(cell, program, Limit::kSlowestFeed);
  EXPECT_THAT(said, HasSubstr("S001: "));
  EXPECT_THAT(said, HasSubstr("in phase cut at"));
  EXPECT_THAT(said, HasSubstr(" would slow the cut to "));
  EXPECT_THAT(said, HasSubstr(" mm/s, 1 mm/s at least (motion.min_feed_mm_s)"));
  EXPECT_THAT(said, HasSubstr("too slow a cut for a joint"));
}

TEST(WithArms, RefusesWhatLeavesTheEnvelope) {
  robot::Cell cell = cell_named("two_irb4600");
  Program program = slow_vault();
  program.settings.machine.envelope_mm = {4000, 4000, 300};
  cell.place.raise_mm = {300, 400};
  EXPECT_THAT(refusal_in(cell, program, Limit::kEnvelope), HasSubstr("at any height of cell.raise_mm"));
}

TEST(WithArms, HasAHashOfTheWholeCell) {
  robot::Cell cell = cell_named("two_irb4600");
  const auto hash = [&] { return with_arms(slow_vault(), cell).program.cell->sha256; };
  const std::string before = hash();
  EXPECT_EQ(hash(), before);
  cell.place.how = robot::Placing::kSearch;
  EXPECT_EQ(hash(), before) << "joints are checked the same wherever a block may have been put";
  cell.margins.wrist_deg = 4;
  EXPECT_NE(hash(), before);
  cell.margins.wrist_deg = 5;
  cell.arms[0].model_text += " ";
  EXPECT_NE(hash(), before);
}

TEST(WithArms, ForgetsTheArmsThatWereThere) {
  robot::Cell cell = cell_named("two_irb4600");
  const Program once = with_arms(slow_vault(), cell).program;
  ASSERT_GT(once.strips[0].arms->raise_mm, 0);
  const ArmedProgram twice = with_arms(once, cell);
  ASSERT_THAT(twice.report.refusals, IsEmpty());
  EXPECT_EQ(to_json(twice.program), to_json(once));
}

TEST(WithArms, SaysWhatIsLeftToLookAt) {
  Program program = slow_vault();
  program.verification.not_checked = {"melt-back", "arm reach and arm collision"};
  const Program armed = with_arms(program, cell_named("two_kr50")).program;
  EXPECT_THAT(armed.verification.not_checked[1], HasSubstr("the arms' approach from park"));
}

TEST(WithArms, SaysWhatHasNoShape) {
  const robot::Cell cell = cell_named("two_irb4600");
  robot::Cell bare = cell;
  bare.arms[0].model.shapeless = {"link_2", "link_4"};
  bare.arms[1].tool.shapes.clear();
  const std::string links = "collisions of links that have no shape, of arm R1: link_2, link_4",
                    tool = "collisions of the tool of arm R2, which has no shape";
  const ArmedProgram armed = with_arms(slow_vault(), bare);
  EXPECT_THAT(armed.report.warnings,
              ::testing::Contains("arm R1: no collision shape in its model: link_2, link_4"));
  EXPECT_THAT(armed.report.warnings, ::testing::Contains("arm R2: the tool has no shape: give its boxes"));
  EXPECT_THAT(not_looked_at(bare), ::testing::ElementsAre(links, tool));
  const auto& items = armed.program.verification.not_checked;
  EXPECT_THAT(items, ::testing::Contains(links).Times(1));
  EXPECT_THAT(items, ::testing::Contains(tool).Times(1));
  // In another cell they are looked at.
  EXPECT_THAT(with_arms(armed.program, cell).program.verification.not_checked,
              ::testing::Not(::testing::Contains(HasSubstr("collisions of"))));
  EXPECT_THAT(not_looked_at(cell), IsEmpty());
}

Program armed_vault(const robot::Cell& cell) {
  return with_arms(slow_vault(), cell).program;
}

TEST(CheckJoints, FindsNothingInWhatWasFound) {
  for (const char* name : {"two_irb4600", "two_kr50"}) {
    const robot::Cell cell = cell_named(name);
    const Program program = armed_vault(cell);
    const JointCheck check = check_joints(program, cell);
    EXPECT_THAT(check.breaches, IsEmpty());
    EXPECT_LE(check.off_mm, 1e-7);  // joints are written to 1e-11 rad
    EXPECT_LE(check.off_rad, 1e-10);
    EXPECT_NEAR(check.joint_margin_rad, program.strips[0].arms->joint_margin_rad.value, 1e-10);
    EXPECT_NEAR(check.wrist_rad, program.strips[0].arms->wrist_rad.value, 1e-10);
    EXPECT_GT(check.speed_share, 0);
    EXPECT_LE(check.speed_share, 1);
    EXPECT_LE(check.acceleration_share, 1);
    EXPECT_LE(check.jerk_share, 1);
  }
}

TEST(CheckJoints, FindsPlantedFaults) {
  const robot::Cell cell = cell_named("two_irb4600");
  const auto breach = [&](const std::function<void(Program&)>& plant) {
    Program program = armed_vault(cell);
    plant(program);
    const JointCheck check = check_joints(program, cell);
    std::string all;
    for (const std::string& line : check.breaches) all += line + "\n";
    return all;
  };
  EXPECT_THAT(breach([](Program& p) { p.strips[0].joints[7].b[2] += 1e-8; }), HasSubstr(" s: arm R2: jaw"));
  EXPECT_THAT(breach([](Program& p) { p.strips[0].design_to_cell.p.z() += 0.001; }),
              HasSubstr("off clamp a"));
  EXPECT_THAT(breach([](Program& p) { p.strips[0].arms->a.flip = !p.strips[0].arms->a.flip; }),
              HasSubstr("off clamp a"));
  EXPECT_THAT(breach([](Program& p) { p.strips[0].joints[7].a[4] = 2.09; }),
              HasSubstr("of its limit, 3 are kept"));
  EXPECT_THAT(breach([](Program& p) { p.strips[0].joints[7].a[4] = 0.01; }),
              HasSubstr("from straight, 5 at least"));
  EXPECT_THAT(breach([](Program& p) { p.strips[0].arms->nearest_mm.clear(); }),
              HasSubstr("mm, the program has none within 500: an older version may have placed it"));
  const std::string fast = breach([](Program& p) {
    for (BladePose& pose : p.strips[0].poses) pose.t /= 1000;
  });
  EXPECT_THAT(fast, HasSubstr("% of its speed"));
  EXPECT_THAT(fast, HasSubstr("% of its acceleration"));
  EXPECT_THAT(fast, HasSubstr("% of its jerk"));
}

TEST(CheckJoints, NeedsJointsOfThisCell) {
  const robot::Cell cell = cell_named("two_irb4600");
  robot::Cell other = cell;
  other.arms[0].base.p.x() += 1;
  const auto message = [&](const Program& program) {
    try {
      (void)check_joints(program, other);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::kBadInput);
      return std::string(error.what());
    }
    return std::string("it was taken");
  };
  EXPECT_THAT(message(armed_vault(cell)), HasSubstr("are those of another cell"));
  EXPECT_THAT(message(slow_vault()), HasSubstr("the program has no joints"));
}

}  // namespace
}  // namespace hotblade::pipeline
