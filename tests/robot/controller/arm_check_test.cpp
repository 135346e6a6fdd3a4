// A controller that knows its arms: what they can do passes, and each planted fault is refused by its code,
// with the part that breaks and by how much.
#include "robot/controller/arm_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "robot/client/client.hpp"
#include "robot/controller/controller.hpp"
#include "robot/pose/motion.hpp"
#include "tests/robot/controller/arm_check_fixture.hpp"
#include "tests/robot/controller/arm_job.hpp"
#include "tests/robot/controller/simulator_fixture.hpp"

namespace hotblade::robot {
namespace {

using protocol::ArmsOther;
using protocol::Op;
using protocol::Result;
using protocol::State;
using testing::ArmCheckTest;
using testing::declared;
using testing::planned_joints;
using testing::Poses;
using testing::sample_cell;
using testing::shared_cell;

constexpr double kUrad = 1e-6;

constexpr std::size_t kWaypoints = 240;

TEST_F(ArmCheckTest, TakesWhatTheArmsCanDoAndLogsTheirJoints) {
  use(sample_cell(), testing::sample_job(kWaypoints), {5000, 20});
  EXPECT_NE(controller->ident().capabilities & protocol::kCapArms, 0);
  ASSERT_NO_FATAL_FAILURE(expect_clean());
  // By the closed form the joints hold the clamps of the line that they stand in.
  ASSERT_GT(log.poses.size(), 1000u);
  for (const PoseSample& sample : log.poses) {
    ASSERT_TRUE(sample.joints);
    for (const std::size_t clamp : {0, 1}) {
      const CellArm& arm = cell.arms[clamp];
      const Eigen::Isometry3d jaw = testing::place_of(arm.base) *
                                    forward(arm.model.arm, (*sample.joints)[clamp]) * jaw_in_flange(arm.tool);
      EXPECT_LE((jaw.translation() - (clamp == 0 ? sample.a : sample.b).p).norm(), 1e-6);
    }
  }
  // They are those of the branch that was declared, at every waypoint.
  EXPECT_LE((*log.poses.back().joints)[0].cwiseAbs().maxCoeff(), 4);
  EXPECT_LE(((*log.poses.back().joints)[0] - joints[0].back()).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LE(((*log.poses.back().joints)[1] - joints[1].back()).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_NE(std::find(log.events.begin(), log.events.end(), "arms"), log.events.end());
}

TEST_F(ArmCheckTest, Code20StartsNothingWithoutTheArmsOfItsCell) {
  use(sample_cell(), testing::sample_job(kWaypoints));
  ASSERT_EQ(push(), Result::kOk);
  const auto start_refused = [&] {
    EXPECT_EQ(command(Op::kStart, token), Result::kState);
    EXPECT_EQ(controller->status().state, State::kOpen);
    EXPECT_EQ(controller->status().fault_detail, 20);
  };
  start_refused();
  protocol::Arms other = declared(joints);
  other.cell_id ^= 1;
  ASSERT_EQ(declare(other), Result::kOk);
  start_refused();
  // Joint 1 is 1.5 m and more from the clamps.
  protocol::Arms off = declared(joints);
  off.joints_rad[1][0] += 1e-5;
  ASSERT_EQ(declare(off), Result::kOk);
  start_refused();
  ASSERT_EQ(declare(declared(joints)), Result::kOk);
  EXPECT_EQ(command(Op::kStart, token), Result::kOk);
  EXPECT_EQ(declare(off), Result::kState) << "the motion has started";
  EXPECT_EQ(declare(declared(joints)), Result::kOk) << "said again, nothing new";
}

TEST_F(ArmCheckTest, ArmsMayBeExchangedAtTheClamps) {
  use(sample_cell(), testing::sample_job(kWaypoints));
  std::swap(cell.arms[0], cell.arms[1]);
  begin();
  ASSERT_NO_FATAL_FAILURE(expect_clean());
}

TEST_F(ArmCheckTest, SomebodyElsesArmsAreNotTaken) {
  use(sample_cell(), testing::sample_job(kWaypoints));
  protocol::DecodedArms arms{declared(joints, token + 1), true};
  EXPECT_EQ(controller->arms(arms, 7, 0), Result::kBadToken);
  arms = {declared(joints, token), false};
  EXPECT_EQ(controller->arms(arms, kOwner, 0), Result::kBadCrc);
}

// Both clamps go away from arm R1, whose base stands back so far that it stretches and falls short.
TEST_F(ArmCheckTest, Code21DoesNotReach) {
  Cell far = testing::bodiless(sample_cell());
  far.arms[0].base.p.x() = -2700;
  far.margins = {0, 0, 0, 0};
  std::vector<Waypoint> way;
  for (std::uint32_t k = 0; k <= 400; ++k) {
    const double share = (1 - std::cos(std::numbers::pi * k / 400)) / 2;
    way.push_back(testing::arc_waypoint(50000 * k, {650 * share, 0, 900}, 0.13, 0, false));
  }
  job = make_job(sha256({}), "S001", way, testing::sample_blade());
  cell = far;
  // Joints for what it reaches.
  Job part = job;
  part.raw.resize(100);
  joints = planned_joints(cell, part);
  ASSERT_EQ(joints[0].size(), 100u);
  begin();
  EXPECT_EQ(refused(), Limit::kArmReach);
  const auto status = controller->status();
  EXPECT_EQ(status.arms.arm, 1);
  const Waypoint at = protocol::decode_waypoint(job.raw[status.fault_sequence]).waypoint;
  // What the closed form says of the reach at the waypoint, whose samples before it were within.
  const CellArm& arm = cell.arms[0];
  const Reach reach = robot::reach(arm.model.arm, testing::place_of(arm.base).inverse() *
                                                      testing::jaw_of(at.a, false, false) *
                                                      jaw_in_flange(arm.tool).inverse());
  EXPECT_GT(reach.from_axis_2_mm, reach.most_mm);
  EXPECT_GT(status.arms.amount, 0);
  EXPECT_LE(status.arms.amount * 1e-3, 2 * (reach.from_axis_2_mm - reach.most_mm) + 0.01);
}

TEST_F(ArmCheckTest, Code22JointLimit) {
  use(sample_cell(), testing::sample_job(kWaypoints));
  ASSERT_NO_FATAL_FAILURE(expect_clean());
  double highest = -10;
  for (const JointAngles& q : joints[1]) highest = std::max(highest, q[2]);
  JointAngles low, high;
  for (int i = 0; i < 6; ++i) {
    low[i] = cell.arms[1].model.arm.joints()[static_cast<std::size_t>(i)].min_rad;
    high[i] = cell.arms[1].model.arm.joints()[static_cast<std::size_t>(i)].max_rad;
  }
  constexpr double kShort_rad = 0.01;
  high[2] = highest + cell.margins.joint_deg * kDegree_rad - kShort_rad;
  cell.arms[1].model.arm = cell.arms[1].model.arm.with_limits(low, high);
  begin();
  EXPECT_EQ(refused(), Limit::kJointAngle);
  const auto detail = controller->status().arms;
  EXPECT_EQ(detail.arm, 2);
  EXPECT_EQ(detail.part, 3);
  EXPECT_GT(detail.amount, 0);
  EXPECT_LE(detail.amount * kUrad, kShort_rad);
  EXPECT_NE(describe(detail, Limit::kJointAngle, {"R1", "R2"}).find("arm R2 joint 3, 0.0"), std::string::npos)
      << describe(detail, Limit::kJointAngle, {"R1", "R2"});
}

// The largest speed, acceleration or jerk of a joint along the job, by differences of the planned joints.
double largest_difference(const std::vector<JointAngles>& q, int joint, int order, double dt) {
  std::vector<double> v;
  for (const JointAngles& angles : q) v.push_back(angles[joint]);
  v.insert(v.begin(), 3, v.front());
  v.insert(v.end(), 3, v.back());
  for (int n = 0; n < order; ++n) {
    for (std::size_t i = 0; i + 1 < v.size(); ++i) v[i] = (v[i + 1] - v[i]) / dt;
    v.pop_back();
  }
  double most = 0;
  for (const double x : v) most = std::max(most, std::abs(x));
  return most;
}

TEST_F(ArmCheckTest, Code23JointSpeed) {
  use(sample_cell(), testing::sample_job(kWaypoints));
  const double most = largest_difference(joints[0], 1, 1, 0.05);
  const double share = cell.arms[0].speed_share;
  // 1 % less than what joint 2 needs; other joints are as they were.
  JointAngles limits;
  std::array<Joint, kJoints> slower = cell.arms[0].model.arm.joints();
  slower[1].speed_rad_s = 0.99 * most / share;
  cell.arms[0].model.arm = Arm("slow", slower, cell.arms[0].model.arm.flange_at_zero());
  begin();
  EXPECT_EQ(refused(), Limit::kJointSpeed);
  const auto detail = controller->status().arms;
  EXPECT_EQ(detail.arm, 1);
  EXPECT_EQ(detail.part, 2);
  EXPECT_GT(detail.amount, 0);
  EXPECT_LE(detail.amount * kUrad, 0.0101 * most);
}

TEST_F(ArmCheckTest, Code24JointAccelerationWithTheRampOfAHold) {
  use(sample_cell(), testing::sample_job(kWaypoints));
  // What the motion itself needs, and a hundredth of what a hold adds to it.
  const double motion = largest_difference(joints[1], 1, 2, 0.05),
               speed = largest_difference(joints[1], 1, 1, 0.05);
  cell.arms[1].acceleration_rad_s2[1] = std::max(motion, 1.9 * speed);
  begin();
  EXPECT_EQ(refused(), Limit::kJointAcceleration);
  EXPECT_EQ(controller->status().arms.arm, 2);
  EXPECT_EQ(controller->status().arms.part, 2);
  EXPECT_GT(controller->status().arms.amount, 0);
  EXPECT_LE(controller->status().arms.amount * kUrad, motion + 2 * speed);
}

TEST_F(ArmCheckTest, Code25NextToSingular) {
  use(sample_cell(), testing::sample_job(kWaypoints));
  const PathMargins margins = path_margins(cell.arms[0].model.arm, joints[0]);
  const PathMargins other = path_margins(cell.arms[1].model.arm, joints[1]);
  const ArmMargins kept = cell.margins;
  const auto expect = [&](int part, double amount, double counts) {
    begin();
    EXPECT_EQ(refused(), Limit::kNearSingular);
    EXPECT_EQ(controller->status().arms.part, part);
    EXPECT_GT(controller->status().arms.amount, 0);
    EXPECT_LE(controller->status().arms.amount / counts, amount);
    cell.margins = kept;
  };
  cell.margins.wrist_deg = std::min(margins.wrist_rad.value, other.wrist_rad.value) / kDegree_rad + 1;
  expect(5, kDegree_rad + 1e-6, 1e6);
  cell.margins.elbow_deg = std::min(margins.elbow_rad.value, other.elbow_rad.value) / kDegree_rad + 1;
  expect(3, kDegree_rad + 1e-6, 1e6);
  cell.margins.shoulder_mm = std::min(margins.shoulder_mm.value, other.shoulder_mm.value) + 30;
  expect(1, 30.001, 1e3);
}

// The blade is carried through a straight wrist of arm R1, whose base stands where that is at half way.
TEST_F(ArmCheckTest, Code26ConfigurationWouldChange) {
  Cell through = testing::bodiless(sample_cell());
  through.margins = {0, 0, 0, 0};
  const Waypoint first = testing::arc_waypoint(0, {0, 0, 900}, 0.13, 0, false);
  const JointAngles easy = (JointAngles() << 0.1, 0.2, 0.1, 0.3, 0.9, -0.2).finished();
  JointAngles bent = easy;
  bent[4] = 0.1;
  const auto stand = [&](CellArm& arm, const JointAngles& q, const Eigen::Isometry3d& jaw) {
    const Eigen::Isometry3d base =
        jaw * jaw_in_flange(arm.tool).inverse() * forward(arm.model.arm, q).inverse();
    arm.base = {base.translation(), Eigen::Quaterniond(base.linear()).normalized()};
  };
  stand(through.arms[0], bent, testing::jaw_of(first.a, false, false));
  stand(through.arms[1], easy, testing::jaw_of(first.b, true, false));
  std::vector<Waypoint> way;
  const Eigen::Isometry3d to_b = testing::place_of(first.a).inverse() * testing::place_of(first.b);
  for (std::uint32_t k = 0; k <= 200; ++k) {
    JointAngles q = bent;
    q[4] -= 0.2 * (1 - std::cos(std::numbers::pi * k / 200)) / 2;
    const CellArm& arm = through.arms[0];
    const Eigen::Isometry3d a =
        testing::place_of(arm.base) * forward(arm.model.arm, q) * jaw_in_flange(arm.tool);
    const Eigen::Isometry3d b = a * to_b;
    way.push_back({50000 * k,
                   false,
                   {a.translation(), Eigen::Quaterniond(a.linear())},
                   {b.translation(), Eigen::Quaterniond(b.linear())}});
  }
  job = make_job(sha256({}), "S001", way, testing::sample_blade());
  cell = through;
  joints = {std::vector<JointAngles>{bent}, std::vector<JointAngles>{easy}};
  begin();
  EXPECT_EQ(refused(), Limit::kConfiguration)
      << controller->status().fault_sequence << ": "
      << describe(controller->status().arms, limit_of_code(controller->status().fault_detail), {});
  EXPECT_EQ(controller->status().arms.arm, 1);
  EXPECT_EQ(controller->status().arms.part, 5);
  // Half way, but for the window that it came in.
  EXPECT_NEAR(controller->status().fault_sequence, 100, 2);
}

TEST_F(ArmCheckTest, Code27ComesTooNear) {
  use(sample_cell(), testing::sample_job(kWaypoints));
  // A box under the tool of clamp A, whose lowest place leaves it 10 mm.
  double lowest = 1e9;
  Eigen::Vector3d tool(0, 0, 0);
  for (const JointAngles& q : joints[0]) {
    const CellArm& arm = cell.arms[0];
    const Eigen::Isometry3d flange = testing::place_of(arm.base) * forward(arm.model.arm, q);
    for (const double x : {-20.0, 20.0}) {
      for (const double y : {-20.0, 20.0}) {
        for (const double z : {0.0, 235.0})
          lowest = std::min(lowest, (flange * Eigen::Vector3d(x, y, z)).z());
      }
    }
    tool = flange * Eigen::Vector3d(0, 0, 190);
  }
  Obstacle box{"box", {}, {Eigen::Isometry3d::Identity(), Box{{60, 500, 100}}}};
  box.at.p = {tool.x(), tool.y(), lowest - 10 - 50};
  cell.obstacles.push_back(box);
  begin();
  EXPECT_EQ(refused(), Limit::kArmClearance);
  auto detail = controller->status().arms;
  EXPECT_EQ(detail.arm, 1);
  EXPECT_EQ(detail.part, 7);
  EXPECT_EQ(detail.other, ArmsOther::kObstacle);
  EXPECT_GT(detail.amount, 0);
  EXPECT_LE(detail.amount * 1e-3, 10.1);
  EXPECT_EQ(describe(detail, Limit::kArmClearance, {"R1", "R2"}).substr(0, 28),
            "arm R1 tool and an obstacle,");
  // A jaw that leaves the end of the blade beside the arm: the blade itself comes too near.
  cell.obstacles.clear();
  cell.clearances.others_mm = 400;
  cell.table_mm.reset();
  begin();
  EXPECT_EQ(refused(), Limit::kArmClearance);
  EXPECT_EQ(controller->status().arms.other, ArmsOther::kBlade);
}

TEST_F(ArmCheckTest, Code28JerkOfJointsAndClamps) {
  use(sample_cell(), testing::sample_job(60));
  const double most = largest_difference(joints[0], 2, 3, 0.05);
  cell.arms[0].jerk_rad_s3[2] = most / 2;
  begin();
  EXPECT_EQ(refused(), Limit::kJointJerk);
  auto detail = controller->status().arms;
  EXPECT_EQ(detail.arm, 1);
  EXPECT_EQ(detail.part, 3);
  EXPECT_GT(detail.amount, 0);
  EXPECT_LE(detail.amount * kUrad, 0.6 * most);
  use(sample_cell(), testing::sample_job(kWaypoints), {10, 0});
  EXPECT_EQ(refused(), Limit::kJointJerk);
  detail = controller->status().arms;
  EXPECT_EQ(detail.arm, 0);
  EXPECT_NE(describe(detail, Limit::kJointJerk, {}).find(" mm/s3 over"), std::string::npos);
}

// Whole micrometres 5 ms apart make tens of thousands of mm/s^3, which are none of the motion's.
TEST_F(ArmCheckTest, RoundingIsNoJerk) {
  use(sample_cell(), testing::sample_job(2400, "S001", 5000), {300, 1});
  controller.reset();
  ControllerOptions unused;
  begin({300, 1});
  ASSERT_EQ(declare(declared(joints)), Result::kOk);
  std::uint32_t accepted = 0;
  while (accepted < 900) {
    protocol::Window w;
    w.token = token;
    w.first_sequence = accepted;
    w.count = 4;
    w.crc_ok = true;
    for (std::uint32_t i = 0; i < w.count; ++i) w.raw.at(i) = job.raw.at(accepted + i);
    ASSERT_EQ(controller->window(w, kOwner, 0), Result::kOk)
        << describe(controller->status().arms, limit_of_code(controller->status().fault_detail), {});
    accepted += 4;
  }
}

// Joints by Newton's method from the pose before are those of the closed form's branch, wherever both arms
// go.
TEST(ArmFollower, AgreesWithTheClosedForm) {
  std::mt19937_64 random(5);
  const Cell cell = sample_cell();
  const CellArm& arm = cell.arms[1];
  int followed_at_all = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const JointAngles from = random_joints(arm.model.arm, random);
    const SingularityDistances distances = singularity_distances(arm.model.arm, from);
    if (distances.wrist_rad < 0.1 || distances.elbow_rad < 0.1 || distances.shoulder_mm < 100) continue;
    JointAngles to = from;
    for (int i = 0; i < 6; ++i) to[i] += std::uniform_real_distribution(-0.01, 0.01)(random);
    const Eigen::Isometry3d jaw =
        testing::place_of(arm.base) * forward(arm.model.arm, to) * jaw_in_flange(arm.tool);
    const FollowedJoints followed = follow(arm, from, jaw);
    ASSERT_TRUE(followed.there);
    EXPECT_LE((followed.q - to).cwiseAbs().maxCoeff(), 1e-9);
    const ArmBends bends = bends_of(posture_of(arm, to));
    const SingularityDistances known = singularity_distances(arm.model.arm, to);
    EXPECT_NEAR(std::abs(bends.wrist_rad), known.wrist_rad, 1e-12);
    EXPECT_NEAR(std::abs(bends.elbow_rad), known.elbow_rad, 1e-12);
    EXPECT_NEAR(std::abs(bends.shoulder_mm), known.shoulder_mm, 1e-9);
    ++followed_at_all;
  }
  EXPECT_GT(followed_at_all, 1000);
}

// What is left out between two distances changes nothing: every sample asked by brute force says the same.
TEST(ArmWatchOver, FindsWhatEverySampleFinds) {
  const Job job = testing::sample_job(100);
  for (const double x : {-520.0, -450.0, -700.0}) {
    Cell cell = sample_cell();
    const auto joints = planned_joints(cell, job);
    Obstacle box{"box", {}, {Eigen::Isometry3d::Identity(), Box{{100, 100, 100}}}};
    box.at.p = {x, 0, 740};
    cell.obstacles.push_back(box);
    const auto shared = shared_cell(cell);
    ArmWatch watch(*shared, job.id, 8);
    std::optional<std::size_t> first_watched, first_asked;
    std::size_t asked_last = 0;
    for (std::size_t k = 0; k < joints[0].size(); ++k) {
      const std::array<ArmPosture, 2> arms{posture_of(cell.arms[0], joints[0][k]),
                                           posture_of(cell.arms[1], joints[1][k])};
      if (!first_watched && watch.look(*shared, arms, std::nullopt)) first_watched = k;
      ArmWatch fresh(*shared, job.id, 8);
      if (!first_asked && fresh.look(*shared, arms, std::nullopt)) first_asked = k;
      asked_last = fresh.asked();
    }
    EXPECT_EQ(first_watched, first_asked) << x;
    if (!first_asked) {
      EXPECT_LT(watch.asked(), joints[0].size() * asked_last / 5) << x;
    }
  }
}

TEST(ArmsOnTheWire, AClientDeclaresThemWhereTheControllerAsksForThem) {
  Job job = testing::sample_job(kWaypoints);
  const Cell cell = sample_cell();
  const auto joints = planned_joints(cell, job);
  StreamOptions stream_options;
  for (const bool knows : {true, false}) {
    for (const bool has : {true, false}) {
      ControllerOptions options;
      options.time_scale = kAsFastAsDataComes;
      if (knows) options.arms = shared_cell(cell);
      testing::Simulator simulator(options);
      job.arms.reset();
      if (has) job.arms = JobArms{declared(joints), {"R1", "R2"}};
      stream_options.port = simulator.port();
      const StreamReport report = stream(job, stream_options);
      if (knows && !has) {
        EXPECT_EQ(report.outcome, StreamOutcome::kRefused);
        EXPECT_NE(report.message.find("checks its arms, and the program has none"), std::string::npos)
            << report.message;
        continue;
      }
      EXPECT_EQ(report.outcome, StreamOutcome::kDone) << report.message;
      EXPECT_TRUE(simulator.proof_of(job).holds());
    }
  }
  // Refused with the part and the amount.
  Cell narrow = cell;
  narrow.margins.wrist_deg = 80;
  ControllerOptions options;
  options.time_scale = kAsFastAsDataComes;
  options.arms = shared_cell(narrow);
  testing::Simulator simulator(options);
  job.arms = JobArms{declared(joints), {"R1", "R2"}};
  stream_options.port = simulator.port();
  const StreamReport report = stream(job, stream_options);
  EXPECT_EQ(report.outcome, StreamOutcome::kRefused);
  EXPECT_NE(report.message.find("arm is next to singular (arm R"), std::string::npos) << report.message;
  EXPECT_NE(report.message.find(" wrist, "), std::string::npos) << report.message;
}

// The log is the journal: arms that were declared before a restart need not be declared again.
TEST(ArmsInTheJournal, ARestartGoesOnWithThem) {
  Job job = testing::sample_job(kWaypoints);
  const Cell cell = sample_cell();
  job.arms = JobArms{declared(planned_joints(cell, job)), {"R1", "R2"}};
  ControllerOptions options;
  options.arms = shared_cell(cell);
  options.faults.add("reboot@100");
  options.time_scale = kAsFastAsDataComes;
  testing::Simulator first(options);
  StreamOptions stream_options;
  stream_options.port = first.port();
  stream_options.link_down_ms = 300;
  EXPECT_EQ(stream(job, stream_options).outcome, StreamOutcome::kLinkLost);
  first.stop();
  const ControllerJournal journal = read_controller_journal(first.log_file());
  ASSERT_TRUE(journal.arms);
  EXPECT_EQ(journal.arms->cell_id, testing::kCellId);
  EXPECT_EQ(journal.arms->joints_rad, job.arms->declared.joints_rad);
  options.faults = {};
  Poses log;
  Controller second(options, &log);
  second.restore(journal);
  ASSERT_EQ(second.status().state, State::kHeld);
  const auto send = [&](Op op, std::uint32_t token) {
    static std::uint32_t nonce = 0;
    const Result result =
        second.command({{++nonce, op, job.id, second.status().run, token, op == Op::kOpen ? job.size() : 0,
                         op == Op::kOpen ? job.blade : ClampedBlade{}},
                        true},
                       1, 10'000'000);
    second.commit();
    return result;
  };
  ASSERT_EQ(send(Op::kOpen, 0), Result::kOk);
  const std::uint32_t token = second.status().token;
  while (second.status().accepted < job.size()) {
    protocol::Window w;
    w.token = token;
    w.first_sequence = second.status().accepted;
    w.count = static_cast<std::uint16_t>(std::min<std::uint32_t>(4, job.size() - w.first_sequence));
    w.last = w.first_sequence + w.count == job.size();
    w.crc_ok = true;
    for (std::uint32_t i = 0; i < w.count; ++i) w.raw.at(i) = job.raw.at(w.first_sequence + i);
    ASSERT_EQ(second.window(w, 1, 10'000'000), Result::kOk) << second.status().fault_detail;
    second.commit();
  }
  ASSERT_EQ(send(Op::kResume, token), Result::kOk);
  for (std::uint64_t us = 10'000'000; us < 40'000'000 && second.status().state == State::kRunning;
       us += 5000) {
    second.heard(1, us);
    second.tick(us);
    second.commit();
  }
  EXPECT_EQ(second.status().state, State::kDone);
  ASSERT_FALSE(log.poses.empty());
  EXPECT_TRUE(log.poses.back().joints);
}

}  // namespace
}  // namespace hotblade::robot
