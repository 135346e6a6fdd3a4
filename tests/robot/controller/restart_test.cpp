// A controller that is restarted from its journal, and the way out of a kerf and back with a blade that went
// cold.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "robot/controller/controller.hpp"
#include "robot/controller/execution_log.hpp"
#include "tests/robot/controller/restart_fixture.hpp"

namespace hotblade::robot {
namespace {

using protocol::Fault;
using protocol::Op;
using protocol::Phase;
using protocol::Result;
using protocol::State;
using testing::sample_job;

using testing::kHeatOff_s;
using testing::kHeatOn_s;

class Restart : public testing::RestartFixture {};

TEST_F(Restart, GoesOnWithWhatWasExecutedAndNothingElse) {
  start();
  wait(1000);
  const auto before = status();
  boot();
  const auto after = status();
  EXPECT_EQ(after.state, State::kHeld);
  EXPECT_EQ(after.fault, Fault::kRestart);
  EXPECT_EQ(after.executed, before.executed);
  EXPECT_EQ(after.executed_crc, before.executed_crc);
  EXPECT_EQ(after.accepted, before.executed) << "what was only accepted is asked for again";
  EXPECT_EQ(after.accepted_crc, before.executed_crc);
  EXPECT_EQ(after.job_id, job_.id);
  EXPECT_EQ(after.run, run_);
  EXPECT_EQ(after.token, before.token);
  EXPECT_EQ(controller_->ident().blade_length_mm, job_.blade.length_mm);
  EXPECT_EQ(send(Op::kResume), Result::kState) << "nobody knows yet where the path goes on";
  resume();
  wait(10500);
  expect_proof();
}

TEST_F(Restart, AtAnyMomentEveryWaypointIsExecutedOnce) {
  std::mt19937 random(3);
  std::vector<PoseSample> poses;
  start();
  for (int boots = 0; boots < 25 && status().state != State::kDone; ++boots) {
    wait(5 * (1 + random() % 900));
    poses.insert(poses.end(), log_->poses.begin(), log_->poses.end());
    if (status().state == State::kDone) break;
    boot();
    if (random() % 3 == 0) boot();  // before anybody came
    resume();
  }
  wait(60000);
  poses.insert(poses.end(), log_->poses.begin(), log_->poses.end());
  expect_proof();
  expect_unbroken_path(poses);
}

TEST_F(Restart, ATornLastLineIsAsIfItHadNotHappened) {
  start();
  wait(3020);
  controller_.reset();
  log_.reset();
  const std::string whole = text();
  for (const std::size_t cut : {5u, 60u, 333u, 2000u, 9001u}) {
    rewrite(whole.substr(0, whole.size() - cut));
    boot();
    EXPECT_EQ(status().state, State::kHeld);
    EXPECT_GE(status().executed, 45u);
    resume();
    wait(20000);
    expect_proof();
  }
}

TEST_F(Restart, KeepsDoneFaultAndEstopAsTheyWere) {
  start();
  wait(2000);
  controller_->estop(now_ms_ * 1000);
  controller_->commit();
  boot();
  EXPECT_EQ(status().state, State::kEstop) << "latched";
  EXPECT_EQ(send(Op::kResume), Result::kState);
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  controller_->commit();
  boot();
  EXPECT_EQ(status().state, State::kIdle);
  ++run_;
  start();
  wait(500);
  ASSERT_EQ(send(Op::kAbort), Result::kOk);
  wait(1000);
  boot();
  EXPECT_EQ(status().state, State::kFault);
  EXPECT_EQ(status().fault, Fault::kAborted);
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  ++run_;
  start();
  wait(10500);
  ASSERT_EQ(status().state, State::kDone);
  boot();
  expect_proof();
  EXPECT_EQ(send(Op::kClose), Result::kOk);
  controller_->commit();
  boot();
  EXPECT_EQ(status().state, State::kIdle);
  EXPECT_EQ(status().job_id, job_.id) << "the last job is remembered, for a client that asks";
  EXPECT_EQ(status().executed, job_.size());
}

TEST_F(Restart, AnEstopWithoutAJobIsLatchedToo) {
  controller_->estop(5000);
  controller_->commit();
  boot();
  EXPECT_EQ(status().state, State::kEstop);
  EXPECT_EQ(send(Op::kReset, 0), Result::kOk);
  controller_->commit();
  boot();
  EXPECT_EQ(status().state, State::kIdle);
}

TEST_F(Restart, TokensOnlyGrow) {
  std::uint32_t last = 0;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(send(Op::kOpen, 0), Result::kOk);
    EXPECT_GT(status().token, last);
    last = status().token;
    ASSERT_EQ(send(Op::kClose), Result::kOk);
    boot();
    EXPECT_EQ(status().token, last);
    ++run_;
  }
}

TEST_F(Restart, AnOpenJobThatNeverMovedIsOpenAgain) {
  ASSERT_EQ(send(Op::kOpen, 0), Result::kOk);
  ASSERT_EQ(push(0, 4), Result::kOk);
  boot();
  EXPECT_EQ(status().state, State::kOpen);
  EXPECT_EQ(status().accepted, 0u);
  fill();
  ASSERT_EQ(send(Op::kStart), Result::kOk);
  wait(10500);
  expect_proof();
}

TEST_F(Restart, RefusesAPathThatDoesNotLeadThroughTheHeldPose) {
  start();
  wait(1020);
  boot();
  const Job planned = job_;
  const auto k = status().accepted;
  auto waypoint = protocol::decode_waypoint(job_.raw[k]).waypoint;
  waypoint.a.p.z() -= 0.2;
  waypoint.b.p.z() -= 0.2;
  job_.raw[k] = *protocol::encode_waypoint(waypoint);
  EXPECT_EQ(push(k, 4), Result::kLimit);
  EXPECT_EQ(status().fault_detail, info(Limit::kHeldPose).code);
  EXPECT_EQ(status().fault_sequence, k);
  EXPECT_EQ(status().accepted, k);
  job_ = planned;
  EXPECT_EQ(push(k, 4), Result::kOk);
}

TEST_F(Restart, RefusesToGoOnWhenTheClampsWereMoved) {
  start();
  wait(1020);
  controller_.reset();
  log_.reset();
  std::string moved = text();
  const auto pose = moved.rfind("\"a\":{\"p\":[");
  const auto digit = moved.find('.', pose) - 1;
  moved[digit] = moved[digit] == '5' ? '6' : '5';
  rewrite(moved);
  boot();
  EXPECT_EQ(push(status().accepted, 4), Result::kLimit);
  EXPECT_EQ(status().fault_detail, info(Limit::kHeldPose).code);
}

TEST_F(Restart, AJournalThatDoesNotHoldIsNotGoneOnFrom) {
  start();
  wait(1020);
  controller_.reset();
  log_.reset();
  const std::string whole = text();
  std::string changed = whole;
  const auto at = changed.find("\"raw\":\"", changed.find("\"seq\":9,\"t_plan\"")) + 20;
  changed[at] = changed[at] == '0' ? '1' : '0';
  rewrite(changed);
  EXPECT_THROW((void)read_controller_journal(file_), LogError);
  const auto ninth = whole.find("{\"ev\":\"exec\"", whole.find("\"seq\":8,\"t_plan\""));
  changed = whole;
  changed.erase(ninth, changed.find('\n', ninth) + 1 - ninth);
  rewrite(changed);
  EXPECT_THROW((void)read_controller_journal(file_), LogError) << "a waypoint is missing";
  rewrite(whole);
  Controller stricter([] {
    ControllerOptions options;
    options.limits.speed_mm_s = 0.5;
    return options;
  }());
  EXPECT_THROW(stricter.restore(read_controller_journal(file_)), LogError) << "another machine";
  boot();
}

TEST_F(Restart, ALogServesOneControllerAtATime) {
  EXPECT_THROW(ExecutionLog(file_, {}), LogError);
}

TEST_F(Restart, AColdBladeGoesBackOutOfItsKerfReheatsAndReturns) {
  start();
  wait(5000);
  hold_until_cold();
  const double held_s = log_->poses.back().path_s;
  const auto executed = status().executed;
  log_->poses.clear();
  resume();
  EXPECT_EQ(status().phase, Phase::kRetract);
  wait(1000);
  EXPECT_EQ(status().executed, executed) << "what was executed stays executed";
  wait(20000);
  expect_proof();
  const std::vector<std::string> way{"cold", "resume", "retract", "reheat", "reenter", "done"};
  EXPECT_TRUE(std::equal(way.begin(), way.end(), log_->events.end() - 6));
  const auto& poses = log_->poses;
  expect_unbroken_path(poses);
  const auto turn =
      std::min_element(poses.begin(), poses.end(),
                       [](const PoseSample& a, const PoseSample& b) { return a.path_s < b.path_s; });
  EXPECT_NEAR(turn->path_s, kHeatOn_s, 0.051) << "where the program heats the blade";
  EXPECT_EQ(turn->path_s, protocol::time_us(job_.raw[turn->sequence]) * 1e-6) << "exactly";
  EXPECT_TRUE(protocol::is_hot(job_.raw[turn->sequence]));
  EXPECT_FALSE(protocol::is_hot(job_.raw[turn->sequence - 1]));
  for (auto p = poses.begin(); p != turn; ++p) EXPECT_FALSE(p->heat) << "cold on the way out";
  const auto back = std::find_if(turn, poses.end(), [&](const PoseSample& p) { return p.path_s >= held_s; });
  ASSERT_NE(back, poses.end());
  for (auto p = turn + 1; p != back; ++p) EXPECT_TRUE(p->heat) << "hot on the way in, " << p->path_s;
  const auto dwell = std::count_if(turn, back, [&](const PoseSample& p) { return p.path_s == turn->path_s; });
  EXPECT_NEAR(static_cast<double>(dwell), options_.reheat_ms / 10.0, 2);
}

TEST_F(Restart, TheWayBackKeepsToTheRampsAcceleration) {
  start();
  wait(5000);
  hold_until_cold();
  log_->poses.clear();
  resume();
  wait(20000);
  const auto& poses = log_->poses;
  double worst = 0;
  for (std::size_t i = 2; i < poses.size(); ++i) {
    if (poses[i].t_us - poses[i - 2].t_us != 20000) continue;  // the extra pose of standing still
    const Eigen::Vector3d second = poses[i].a.p - 2 * poses[i - 1].a.p + poses[i - 2].a.p;
    // Linear steps between waypoints put the change of speed of 50 ms into one pose step of 10 ms.
    worst = std::max(worst, second.norm() / 1e-4 / 5);
  }
  EXPECT_LT(worst, 2 * 60 + 30);
}

TEST_F(Restart, ABladeThatIsStillHotGoesStraightOn) {
  start();
  wait(5000);
  ASSERT_EQ(send(Op::kHold), Result::kOk);
  wait(1000);
  resume();
  EXPECT_EQ(status().phase, Phase::kProgram);
  wait(10000);
  expect_proof();
  EXPECT_EQ(std::count(log_->events.begin(), log_->events.end(), "retract"), 0);
}

TEST_F(Restart, OutsideTheHeatedPartNothingIsRetracted) {
  start();
  wait(1000);
  hold_until_cold();
  resume();
  wait(static_cast<std::uint64_t>(1000 * kHeatOff_s) + 500);
  hold_until_cold();
  resume();
  wait(3000);
  expect_proof();
  EXPECT_EQ(std::count(log_->events.begin(), log_->events.end(), "retract"), 0);
}

TEST_F(Restart, HoldsOnTheWayOutWhileReheatingAndOnTheWayIn) {
  for (const std::uint64_t after_ms : {5, 300, 900, 2300, 2700, 3500, 4600, 5300}) {
    TearDown();
    SetUp();
    start();
    wait(5000);
    hold_until_cold();
    resume();
    wait(after_ms);
    ASSERT_EQ(send(Op::kHold), Result::kOk);
    wait(1000);
    ASSERT_EQ(status().state, State::kHeld);
    const auto standing = log_->poses.back().path_s;
    wait(3000);
    EXPECT_EQ(log_->poses.back().path_s, standing);
    EXPECT_FALSE(log_->poses.back().heat);
    resume();
    wait(20000);
    expect_proof();
    expect_unbroken_path(log_->poses);
  }
}

TEST_F(Restart, SilenceOnTheWayOutHoldsToo) {
  start();
  wait(5000);
  hold_until_cold();
  resume();
  for (int i = 0; i < 800; ++i) controller_->tick((now_ms_ += 5) * 1000);
  EXPECT_EQ(status().state, State::kHeld);
  EXPECT_EQ(status().fault, Fault::kWatchdog);
  EXPECT_EQ(status().phase, Phase::kProgram);
}

TEST_F(Restart, AnInstantClockRetractsAndReturnsToo) {
  options_.time_scale = kAsFastAsDataComes;
  boot();
  ASSERT_EQ(send(Op::kOpen, 0), Result::kOk);
  for (std::uint32_t k = 0; k < 100; k += 4) ASSERT_EQ(push(k, 4), Result::kOk);
  ASSERT_EQ(send(Op::kStart), Result::kOk);
  wait(5);
  EXPECT_EQ(status().executed, 100u);
  boot();
  EXPECT_EQ(status().state, State::kHeld);
  resume();
  wait(5);
  expect_proof();
  EXPECT_EQ(std::count(log_->events.begin(), log_->events.end(), "reenter"), 1);
}

TEST_F(Restart, ALateResumeOfAConnectionGivenUpMovesNothing) {
  start();
  wait(1000);
  ASSERT_EQ(send(Op::kHold, status().token, 9), Result::kOk);
  wait(1000);
  EXPECT_EQ(send(Op::kResume, status().token, 4), Result::kState);
  EXPECT_EQ(status().state, State::kHeld);
  EXPECT_EQ(send(Op::kResume, status().token, 9), Result::kOk);
}

}  // namespace
}  // namespace hotblade::robot
