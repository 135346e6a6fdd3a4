// What a controller says of arms that it refuses: where the blade lies between clamps that are off, and which
// waypoint breaks a limit when arms are declared late.
#include <gtest/gtest.h>

#include <cmath>

#include "robot/controller/arm_check.hpp"
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

constexpr std::size_t kWaypoints = 240;

// A clamp that holds the blade turned is one whose jaw is turned, told where it holds the blade: the same
// joints hold the same blade, as far from the other arm.
TEST_F(ArmCheckTest, TheBladeLiesWhereAClampThatIsOffHoldsIt) {
  Cell at_b = sample_cell();
  at_b.arms[0].model.bodies.clear();
  at_b.arms[0].tool.shapes.clear();
  at_b.table_mm.reset();
  at_b.clearances.others_mm = 400;
  const Job as_held = testing::sample_job(kWaypoints);
  offsets.a = {{1, -2, 3}, {0, 0.05, 0.1}};
  std::vector<Waypoint> told_waypoints = testing::sample_waypoints(kWaypoints);
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

}  // namespace
}  // namespace hotblade::robot
