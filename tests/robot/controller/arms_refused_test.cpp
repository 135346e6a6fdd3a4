// What a controller says of arms that it refuses: where the blade lies between clamps that are off, and which
// waypoint breaks a limit when arms are declared late.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "robot/controller/arm_check.hpp"
#include "robot/controller/execution_log.hpp"
#include "tests/robot/controller/arm_check_fixture.hpp"

namespace hotblade::robot {
namespace {

using protocol::ArmsOther;
using protocol::Op;
using protocol::Result;
using protocol::State;
using testing::ArmCheckTest;
using testing::declared;
using testing::planned_joints;
using testing::sample_cell;

constexpr std::size_t kJobWaypoints = 240;

// A clamp that holds the blade turned is one whose jaw is turned, told where it holds the blade: the same
// joints hold the same blade, as far from the other arm.
TEST_F(ArmCheckTest, TheBladeLiesWhereAClampThatIsOffHoldsIt) {
  Cell at_b = sample_cell();
  at_b.arms[0].model.bodies.clear();
  at_b.arms[0].tool.shapes.clear();
  at_b.table_mm.reset();
  at_b.clearances.others_mm = 400;
  const Job as_held = testing::sample_job(kJobWaypoints);
  offsets.a = {{1, -2, 3}, {0, 0.05, 0.1}};
  std::vector<Waypoint> told_waypoints = testing::sample_waypoints(kJobWaypoints);
  for (Waypoint& w : told_waypoints) w.a = told(w.a, offsets.a);
  use(at_b, make_job(sha256({}), "S001", told_waypoints, testing::sample_blade()));
  ASSERT_EQ(refused(), Limit::kArmClearance);
  const auto by_offset = controller->status().arms;
  EXPECT_EQ(by_offset.arm, 2);
  EXPECT_EQ(by_offset.other, ArmsOther::kBlade);

  ArmTool& tool = cell.arms[0].tool;
  const Eigen::Isometry3d flange =
      testing::place_of(cell.arms[0].base) * forward(cell.arms[0].model.arm, joints[0][0]);
  const Eigen::Isometry3d jaw =
      flange.inverse() * testing::place_of(protocol::decode_waypoint(as_held.raw[0]).waypoint.a);
  tool.jaw_p_mm = jaw.translation();
  tool.jaw_x = jaw.linear().col(0);
  tool.jaw_y = jaw.linear().col(1);
  job = as_held;
  offsets = {};
  begin();
  ASSERT_EQ(refused(), Limit::kArmClearance);
  const auto by_jaw = controller->status().arms;
  EXPECT_EQ(by_offset.part, by_jaw.part);
  constexpr double kRegisters_um = 30;  // joints and clamps are rounded, over the blade's length
  EXPECT_NEAR(by_offset.amount, by_jaw.amount, kRegisters_um);
}

// No arm comes near: the blade does, and the block stands there.
TEST_F(ArmCheckTest, BladeAndBlockKeepFromObstacles) {
  use(sample_cell(), testing::sample_job(kJobWaypoints));
  const Waypoint middle = protocol::decode_waypoint(job.raw[kJobWaypoints / 2]).waypoint;
  Obstacle pin{"pin", {}, {Eigen::Isometry3d::Identity(), Box{{4, 60, 40}}}};
  pin.at.p = (middle.a.p + middle.b.p) / 2;
  cell.obstacles.push_back(pin);
  begin();
  ASSERT_EQ(refused(), Limit::kArmClearance);
  const protocol::ArmsDetail blade = controller->status().arms;
  EXPECT_EQ(blade.arm, 0);
  EXPECT_EQ(blade.part, static_cast<std::uint8_t>(ArmsOther::kBlade));
  EXPECT_EQ(blade.other, ArmsOther::kObstacle);
  EXPECT_EQ(describe(blade, Limit::kArmClearance, {"R1", "R2"}).substr(0, 26), "the blade and an obstacle,");

  const Shape around{testing::place_of(pin.at), Box{{200, 200, 200}}};
  const ArmCell known(cell, testing::kCellId, {},
                      {{job.id, {{Standing::What::kBlock, "the block", {around}}}}});
  const std::array<ArmPosture, 2> arms{posture_of(cell.arms[0], joints[0][0]),
                                       posture_of(cell.arms[1], joints[1][0])};
  const auto stands = ArmWatch(known, job.id, 8).look(known, arms, std::nullopt);
  ASSERT_TRUE(stands);
  EXPECT_EQ(stands->detail, (protocol::ArmsDetail{0, static_cast<std::uint8_t>(ArmsOther::kBlock),
                                                  ArmsOther::kObstacle, 0, 20000}));
  EXPECT_FALSE(ArmWatch(known, job.id + 1, 8).look(known, arms, std::nullopt)) << "another job's block";
}

// The STATE of a START that comes too early is none of the arms' any more.
TEST_F(ArmCheckTest, TheRightArmsTakeBackWhatWasSaidOfTheWrong) {
  use(sample_cell(), testing::sample_job(kJobWaypoints));
  ASSERT_EQ(push(), Result::kOk);
  ASSERT_EQ(command(Op::kStart, token), Result::kState);
  ASSERT_EQ(limit_of_code(controller->status().fault_detail), Limit::kCell);
  ASSERT_EQ(declare(declared(joints)), Result::kOk);
  EXPECT_EQ(controller->status().fault_detail, 0);
  EXPECT_EQ(command(Op::kResume, token), Result::kState);
  EXPECT_EQ(controller->status().fault_detail, 0);
}

// A controller that knew no arms when it was stopped, and is HELD.
class ArmsDeclaredLate : public ArmCheckTest {
 protected:
  void hold_at(std::uint32_t executed, std::uint32_t back_to) {
    ControllerJournal journal;
    journal.state = State::kHeld;
    journal.loaded = true;
    journal.job = job.id;
    journal.run = 1;
    journal.count = job.size();
    journal.blade = job.blade;
    journal.executed.assign(job.raw.begin(), job.raw.begin() + executed);
    Chain chain(job.id);
    for (const auto& raw : journal.executed) journal.chain = chain.add(raw);
    journal.path_s = protocol::time_us(job.raw[back_to]) * 1e-6;
    ControllerOptions options;
    options.arms = testing::shared_cell(cell);
    options.time_scale = kAsFastAsDataComes;
    options.limits.speed_mm_s = 500;
    options.limits.envelope_min_mm = {-4000, -4000, -4000};
    options.limits.envelope_max_mm = {4000, 4000, 4000};
    controller = std::make_unique<Controller>(options, &log);
    controller->restore(journal);
    ASSERT_EQ(controller->status().state, State::kHeld);
    ASSERT_EQ(command(Op::kOpen, 0), Result::kOk);
    token = controller->status().token;
  }
};

TEST_F(ArmsDeclaredLate, NameTheWaypointThatBreaksALimit) {
  use(sample_cell(), testing::sample_job(kJobWaypoints));
  double highest = -10;
  std::uint32_t at = 0;
  JointAngles low, high;
  const Arm& arm = cell.arms[1].model.arm;
  for (int i = 0; i < 6; ++i) {
    low[i] = arm.joints()[static_cast<std::size_t>(i)].min_rad;
    high[i] = arm.joints()[static_cast<std::size_t>(i)].max_rad;
  }
  for (std::uint32_t i = 0; i < job.size(); ++i) {
    if (joints[1][i][2] <= highest) continue;
    highest = joints[1][i][2];
    at = i;
  }
  constexpr double kShort_rad = 0.01;
  high[2] = highest + cell.margins.joint_deg * kDegree_rad - kShort_rad;
  std::uint32_t first = 0;
  while (joints[1][first][2] <= highest - kShort_rad) ++first;
  cell.arms[1].model.arm = arm.with_limits(low, high);
  ASSERT_GT(at, 20u);
  ASSERT_LT(at, 180u);
  ASSERT_NO_FATAL_FAILURE(hold_at(200, 199));
  EXPECT_EQ(declare(declared(joints)), Result::kLimit);
  EXPECT_EQ(limit_of_code(controller->status().fault_detail), Limit::kJointAngle);
  EXPECT_LE(controller->status().fault_sequence, at);
  EXPECT_GE(controller->status().fault_sequence, first);
}

// Joints turn by more between the place where it stands and the last waypoint than any may in 10 ms.
TEST_F(ArmsDeclaredLate, GoOnFromWhereTheBladeStands) {
  Cell wide = testing::bodiless(sample_cell());
  wide.margins = {0, 0, 0, 0};
  std::vector<Waypoint> way;
  for (std::uint32_t k = 0; k <= 400; ++k) {
    const double share = (1 - std::cos(std::numbers::pi * k / 400)) / 2;
    way.push_back(
        testing::arc_waypoint(50000 * k, {0, 0, 900 + 100 * share}, 0.13, 1.4 * share - 0.7, false));
  }
  use(wide, make_job(sha256({}), "S001", way, testing::sample_blade()));
  ASSERT_GT((joints[0][300] - joints[0][20]).cwiseAbs().maxCoeff(), 0.6);
  ASSERT_NO_FATAL_FAILURE(hold_at(301, 20));
  ASSERT_EQ(declare(declared(joints)), Result::kOk);
  ASSERT_EQ(push(), Result::kOk);
  ASSERT_EQ(command(Op::kResume, token), Result::kOk);
  run();
  EXPECT_EQ(controller->status().state, State::kDone)
      << describe(controller->status().arms, limit_of_code(controller->status().fault_detail), {});
}

// A controller that restarts says of a fault what it said before.
TEST_F(ArmCheckTest, TheLogHasWhichPartOfAnArmBroke) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "arm_fault.jsonl";
  std::filesystem::remove(file);
  const protocol::ArmsDetail detail{2, 7, ArmsOther::kBlade, 0, -1234};
  {
    ExecutionLog written(file, {});
    written.event({"open", 1, 1, 1, 0, 4, 0, protocol::Fault::kNone, 0, 0, testing::sample_blade()});
    written.event({"fault",
                   1,
                   1,
                   1,
                   0,
                   4,
                   0,
                   protocol::Fault::kExecutionLimit,
                   info(Limit::kArmClearance).code,
                   3,
                   testing::sample_blade(),
                   {},
                   detail});
    ASSERT_TRUE(written.commit());
  }
  EXPECT_EQ(read_controller_journal(file).fault_arms, detail);
  {
    ExecutionLog written(file, {});
    written.event({"reset", 1, 1, 1, 0, 4, 0});
    ASSERT_TRUE(written.commit());
  }
  EXPECT_EQ(read_controller_journal(file).fault_arms, protocol::ArmsDetail{});
  EXPECT_EQ(describe(protocol::ArmsDetail{}, Limit::kJointAngle, {"R1", "R2"}), "");
}

}  // namespace
}  // namespace hotblade::robot
