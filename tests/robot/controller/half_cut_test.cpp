// A strip that was left half cut: what stands in the way, and the ways out.
#include <gtest/gtest.h>

#include <random>

#include "tests/robot/controller/restart_fixture.hpp"

namespace hotblade::robot {
namespace {

using protocol::Op;
using protocol::Phase;
using protocol::Result;
using protocol::State;
using testing::kHeatOn_s;
using testing::sample_job;

class HalfCut : public testing::RestartFixture {};

TEST_F(HalfCut, AfterEstopAndResetTheBladeInTheFoamIsInTheWay) {
  start();
  wait(4000);
  controller_->estop(now_ms_ * 1000);
  const auto left = status();
  ASSERT_GT(left.executed, 0u);
  EXPECT_FALSE(left.left_in_cut);
  ASSERT_EQ(send(Op::kReset), Result::kOk);
  EXPECT_EQ(status().state, State::kIdle);
  EXPECT_TRUE(status().left_in_cut);
  // Neither the same strip anew nor another one starts at waypoint 0, whoever asks, restarted or not.
  for (int boots = 0; boots < 2; ++boots) {
    run_ = 2;
    EXPECT_EQ(send(Op::kOpen, 0), Result::kLimit);
    EXPECT_EQ(status().fault_detail, info(Limit::kHeldPose).code);
    const Job other = sample_job(150, "S002");
    EXPECT_EQ(controller_->command({{++nonce_, Op::kOpen, other.id, 1, 0, other.size(), other.blade}, true},
                                   1, now_ms_ * 1000),
              Result::kLimit);
    EXPECT_EQ(status().state, State::kIdle);
    EXPECT_EQ(status().executed, left.executed);
    if (boots == 0) boot();
    EXPECT_TRUE(status().left_in_cut) << "a restart forgets nothing";
  }
  run_ = 1;
  EXPECT_EQ(send(Op::kRelease, 0), Result::kOk);
  EXPECT_FALSE(status().left_in_cut);
  boot();
  EXPECT_FALSE(status().left_in_cut);
  controller_->estop(now_ms_ * 1000);
  EXPECT_EQ(send(Op::kReset, 0), Result::kOk);
  EXPECT_FALSE(status().left_in_cut) << "it was freed";
  boot();
  EXPECT_FALSE(status().left_in_cut) << "it was freed";
  run_ = 2;
  start();
  wait(60000);
  expect_proof();
}

TEST_F(HalfCut, OutsideTheFoamResetLeavesNothingInTheWay) {
  start();
  wait(static_cast<std::uint64_t>(kHeatOn_s * 1000) - 500);
  controller_->estop(now_ms_ * 1000);
  ASSERT_EQ(send(Op::kReset), Result::kOk);
  EXPECT_FALSE(status().left_in_cut);
  EXPECT_EQ(send(Op::kRelease, 0), Result::kState);
  run_ = 2;
  EXPECT_EQ(send(Op::kOpen, 0), Result::kOk);
}

// ESTOP, a restart of the controller, or both, at random places in the foam and out of it; then the strip is
// taken up again. Nothing moves before RESUME, and the log is whole.
TEST_F(HalfCut, TakenUpAgainAfterEstopEveryWaypointIsExecutedOnce) {
  std::mt19937 random(11);
  for (int place = 0; place < 20; ++place) {
    TearDown();
    SetUp();
    run_ = 1;
    options_.boot_id += 1;
    start();
    wait(100 + 5 * (random() % 1900));
    if (status().state != State::kRunning) continue;
    const bool estop = place % 3 != 1, reboot = place % 3 != 0;
    std::vector<PoseSample> poses = log_->poses;
    if (estop) controller_->estop(now_ms_ * 1000);
    if (reboot) {
      poses = log_->poses;
      boot();
    }
    if (estop) {
      ASSERT_EQ(status().state, State::kEstop) << place;
      ASSERT_EQ(send(Op::kReset), Result::kOk) << place;
    }
    const auto stood = status();
    const std::size_t poses_before = log_->poses.size();
    wait(20000);
    EXPECT_EQ(status().executed, stood.executed) << "nobody said yes";
    EXPECT_LE(log_->poses.size(), poses_before + 1) << "nobody said yes";
    if (estop && !stood.left_in_cut) {  // out of the foam: anew
      run_ = 2;
      start();
    } else {
      ASSERT_EQ(send(Op::kOpen, status().token), Result::kOk) << place;
      ASSERT_EQ(status().state, State::kHeld) << place;
      resume();
    }
    wait(60000);
    expect_proof();
    expect_unbroken_path(log_->poses);
  }
}

TEST_F(HalfCut, WithdrawnTheBladeGoesBackColdToWhereTheStripBegan) {
  std::mt19937 random(5);
  for (int place = 0; place < 20; ++place) {
    TearDown();
    SetUp();
    run_ = 1;
    start();
    wait(static_cast<std::uint64_t>(kHeatOn_s * 1000) + 100 + 5 * (random() % 900));
    const auto cut = status();
    ASSERT_EQ(cut.state, State::kRunning);
    controller_->estop(now_ms_ * 1000);
    if (place % 2 == 1) boot();
    ASSERT_EQ(send(Op::kReset), Result::kOk);
    ASSERT_EQ(send(Op::kWithdraw), Result::kState) << "the job is not open";
    ASSERT_EQ(send(Op::kOpen, 0), Result::kOk);
    fill();
    const std::size_t before = log_->poses.size();
    ASSERT_EQ(send(Op::kWithdraw), Result::kOk);
    EXPECT_EQ(status().phase, Phase::kRetract);
    wait(30000);
    EXPECT_EQ(status().state, State::kIdle) << place;
    EXPECT_FALSE(status().left_in_cut);
    EXPECT_EQ(status().executed, cut.executed) << "nothing is executed on the way back";
    const std::vector<PoseSample> back(log_->poses.begin() + static_cast<std::ptrdiff_t>(before),
                                       log_->poses.end());
    ASSERT_GT(back.size(), 2u);
    expect_unbroken_path(back);
    for (std::size_t i = 1; i < back.size(); ++i) {
      ASSERT_FALSE(back[i].heat);
      ASSERT_LE(back[i].path_s, back[i - 1].path_s + 1e-9);
    }
    EXPECT_NEAR(back.back().path_s, 0, 1e-6);
    EXPECT_LE((back.back().a.p - protocol::decode_waypoint(job_.raw[0]).waypoint.a.p).norm(), 1e-3);
    // The same strip on a new block.
    run_ = 2;
    start();
    wait(60000);
    expect_proof();
  }
}

TEST_F(HalfCut, AWithdrawalCanBeHeldAndGoesOn) {
  start();
  wait(4500);
  hold_until_cold();
  ASSERT_EQ(send(Op::kWithdraw), Result::kOk);
  wait(1000);
  ASSERT_EQ(send(Op::kHold), Result::kOk);
  wait(2000);
  ASSERT_EQ(status().state, State::kHeld);
  boot();
  fill();
  ASSERT_EQ(send(Op::kWithdraw), Result::kOk);
  wait(20000);
  EXPECT_EQ(status().state, State::kIdle);
}

}  // namespace
}  // namespace hotblade::robot
