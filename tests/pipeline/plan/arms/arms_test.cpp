// Two arms for a program: joints that hold the clamps, and refusals by name and amount.
#include "pipeline/plan/arms/arms.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/plan/arms/strip_arms.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// The vault at a tenth of its speed, which starts and ends abruptly.
Program slow_vault() {
  Program program = testing::vault_program();
  program.settings.machine.envelope_mm = {4000, 4000, 3000};
  for (Strip& strip : program.strips) {
    for (BladePose& pose : strip.poses) pose.t *= 10;
  }
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
      for (const BladePose& pose : strip.poses) {
        for (const bool b : {false, true}) {
          const HeldClamp& held = b ? strip.arms->b : strip.arms->a;
          const robot::CellArm& arm = arm_of(cell, held.arm);
          const ArmJoints& joints = b ? pose.joints->b : pose.joints->a;
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
    EXPECT_LT(score(program.strips[0], cell, {lower, false}), 1) << "a lower place was as good";
  cell.place.how = robot::Placing::kFixed;
  const ArmedProgram fixed = with_arms(program, cell);
  ASSERT_THAT(fixed.report.refusals, IsEmpty());
  EXPECT_EQ(fixed.program.strips[0].arms->raise_mm, 0);
  cell.place.how = robot::Placing::kRaise;
  cell.place.raise_mm = {200, 200};
  EXPECT_EQ(with_arms(program, cell).program.strips[0].arms->raise_mm, 200);
}

TEST(WithArms, SaysTheMarginsThatAreThere) {
  const robot::Cell cell = cell_named("two_kr50");
  const ArmedProgram armed = with_arms(slow_vault(), cell);
  ASSERT_THAT(armed.report.refusals, IsEmpty());
  const Strip& strip = armed.program.strips[0];
  double least = 10;
  for (const BladePose& pose : strip.poses) {
    for (const bool b : {false, true}) {
      const robot::Arm& arm = arm_of(cell, (b ? strip.arms->b : strip.arms->a).arm).model.arm;
      for (std::size_t i = 0; i < kArmJoints; ++i) {
        const double q = b ? pose.joints->b[i] : pose.joints->a[i];
        least = std::min({least, q - arm.joints()[i].min_rad, arm.joints()[i].max_rad - q});
      }
    }
  }
  EXPECT_NEAR(strip.arms->joint_margin_rad.value, least, 1e-12);
  EXPECT_GE(least, cell.margins.joint_deg * robot::kDegree_rad);
}

std::string refusal_in(const robot::Cell& cell, const Program& program, Limit limit) {
  const ArmedProgram armed = with_arms(program, cell);
  if (armed.report.refusals.size() != 1) return "refusals: " + std::to_string(armed.report.refusals.size());
  EXPECT_FALSE(armed.program.cell) << "a refused program has no joints";
  EXPECT_FALSE(armed.program.strips[0].poses[0].joints);
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
  EXPECT_THAT(said, HasSubstr("of 10 choices of height and arms 10 are out of reach"));
}

TEST(WithArms, RefusesALimitJustBelowNeed) {
  robot::Cell cell = cell_named("two_irb4600");
  cell.place.how = robot::Placing::kFixed;
  const Program program = slow_vault();
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
    for (const BladePose& pose : free.program.strips[0].poses)
      reached = std::max(reached, std::abs((b ? pose.joints->b : pose.joints->a)[4]));
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

TEST(WithArms, RefusesJointsThatAreTooFast) {
  robot::Cell cell = cell_named("two_irb4600");
  for (robot::CellArm& arm : cell.arms) arm.speed_share = 0.002;
  EXPECT_THAT(refusal_in(cell, slow_vault(), Limit::kJointSpeed), HasSubstr("arm.speed_share of its speed"));
  cell = cell_named("two_irb4600");
  EXPECT_THAT(refusal_in(cell, testing::vault_program(), Limit::kJointAcceleration),
              HasSubstr("arm.acceleration_rad_s2"))
      << "the vault starts abruptly";
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
  cell.margins.wrist_deg = 4;
  EXPECT_NE(hash(), before);
  cell.margins.wrist_deg = 5;
  cell.arms[0].model_text += " ";
  EXPECT_NE(hash(), before);
}

}  // namespace
}  // namespace hotblade::pipeline
