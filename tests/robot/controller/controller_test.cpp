#include "robot/controller/controller.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "elastica/blade/continuation.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

using protocol::Fault;
using protocol::Op;
using protocol::Result;
using protocol::State;
using testing::sample_job;

// Keeps what it is told.
class Recorder final : public ExecutionSink {
 public:
  struct Executed {
    std::uint32_t sequence;
    std::uint64_t t_exec_us;
    protocol::RawWaypoint raw;
    Sha256 chain;
    std::optional<BladeMargins> margins;
  };
  void executed(const ExecutedWaypoint& w) override {
    waypoints.push_back({w.sequence, w.t_exec_us, w.raw, w.chain, w.margins});
  }
  void pose(const PoseSample& sample) override { poses.push_back(sample); }
  void event(const JobEvent& event) override { events.emplace_back(event.what); }
  bool commit() override { return healthy; }

  std::vector<Executed> waypoints;
  std::vector<PoseSample> poses;
  std::vector<std::string> events;
  bool healthy = true;
};

// A controller, a job, and a clock in ms.
class ControllerTest : public ::testing::Test {
 protected:
  static constexpr Controller::Connection kOwner = 1, kOther = 2;

  void use(double time_scale, std::size_t n = 200, std::uint16_t fifo = 1024) {
    job = sample_job(n);
    options.time_scale = time_scale;
    options.fifo_size = fifo;
    controller = std::make_unique<Controller>(options, &log);
  }
  void SetUp() override { use(1); }

  [[nodiscard]] protocol::Status status() const { return controller->status(); }
  [[nodiscard]] protocol::Command make(Op op, std::uint32_t with_token) {
    return {++nonce,
            op,
            job.id,
            run,
            with_token,
            op == Op::kOpen ? job.size() : 0,
            op == Op::kOpen ? job.blade : ClampedBlade{}};
  }
  Result send(const protocol::Command& c, Controller::Connection from = kOwner) {
    const auto result = controller->command({c, true}, from, now_ms * 1000);
    controller->commit();
    return result;
  }
  Result send(Op op, Controller::Connection from = kOwner) { return send(make(op, token), from); }
  Result open(Controller::Connection from = kOwner) {
    const auto result = send(make(Op::kOpen, 0), from);
    if (result == Result::kOk) token = status().token;
    return result;
  }
  [[nodiscard]] protocol::Window window_of(std::uint32_t first, std::uint32_t n) const {
    protocol::Window w;
    w.token = token;
    w.first_sequence = first;
    w.count = static_cast<std::uint16_t>(n);
    w.last = n > 0 && first + n == job.size();
    w.crc_ok = true;
    for (std::uint32_t i = 0; i < n; ++i) w.raw.at(i) = job.raw.at(first + i);
    return w;
  }
  Result push(const protocol::Window& w, Controller::Connection from = kOwner) {
    const auto result = controller->window(w, from, now_ms * 1000);
    controller->commit();
    return result;
  }
  // Accepts waypoints up to `end`.
  void fill(std::uint32_t end) {
    while (status().accepted < end) {
      const auto at = status().accepted;
      ASSERT_EQ(push(window_of(at, std::min(4u, end - at))), Result::kOk) << at;
    }
  }
  // Time goes on in steps of a tick, with or without the owner's signs of life.
  void wait(std::uint64_t ms, bool alive = true) {
    for (const auto end = now_ms + ms; now_ms < end;) {
      now_ms += 5;
      if (alive) controller->heard(kOwner, now_ms * 1000);
      controller->tick(now_ms * 1000);
      controller->commit();
    }
  }
  void start_with(std::uint32_t accepted) {
    ASSERT_EQ(open(), Result::kOk);
    fill(accepted);
    ASSERT_EQ(send(Op::kStart), Result::kOk);
  }

  Job job;
  ControllerOptions options;
  Recorder log;
  std::unique_ptr<Controller> controller;
  std::uint64_t now_ms = 1000;
  std::uint32_t nonce = 100, run = 1, token = 0;
};

TEST_F(ControllerTest, ExecutesEveryWaypointOnceInOrderAtItsTime) {
  start_with(job.size());
  wait(10500);
  EXPECT_EQ(status().state, State::kDone);
  EXPECT_EQ(status().executed, job.size());
  EXPECT_EQ(status().executed_crc, status().accepted_crc);
  ASSERT_EQ(log.waypoints.size(), job.size());
  Chain chain(job.id);
  for (std::uint32_t k = 0; k < job.size(); ++k) {
    EXPECT_EQ(log.waypoints[k].sequence, k);
    EXPECT_EQ(log.waypoints[k].raw, job.raw[k]);
    EXPECT_EQ(log.waypoints[k].t_exec_us, protocol::time_us(job.raw[k]));
    EXPECT_EQ(log.waypoints[k].chain, chain.add(job.raw[k]));
  }
}

TEST_F(ControllerTest, LogsAPoseEveryTenMillisecondsOnTheInterpolatedPath) {
  start_with(job.size());
  wait(10500);
  ASSERT_EQ(log.poses.size(), 996u);  // 0 to 9.95 s
  for (std::size_t i = 0; i < log.poses.size(); ++i) EXPECT_EQ(log.poses[i].t_us, i * 10000);
  const auto from = protocol::decode_waypoint(job.raw[20]).waypoint,
             to = protocol::decode_waypoint(job.raw[21]).waypoint;
  const PoseSample& sample = log.poses[102];  // 1.02 s, two fifths of the step from 1.00 s
  EXPECT_EQ(sample.sequence, 20u);
  EXPECT_LT((sample.a.p - (0.6 * from.a.p + 0.4 * to.a.p)).norm(), 1e-9);
  EXPECT_LT(sample.b.q.angularDistance(from.b.q.slerp(0.4, to.b.q)), 1e-9);
}

TEST_F(ControllerTest, TimeScaleSpeedsTheMotionOnly) {
  use(10);
  start_with(job.size());
  wait(1100, false);  // 1.1 s of wall time is below the watchdog's 2 s
  EXPECT_EQ(status().state, State::kDone);
  EXPECT_EQ(log.waypoints.back().t_exec_us, protocol::time_us(job.raw.back()));
}

TEST_F(ControllerTest, AnInstantClockExecutesWhatThereIsAndWaits) {
  use(kAsFastAsDataComes);
  start_with(8);
  wait(5);
  EXPECT_EQ(status().executed, 8u);
  wait(1000);
  EXPECT_EQ(status().state, State::kRunning);
  fill(job.size());
  wait(5);
  EXPECT_EQ(status().state, State::kDone);
  EXPECT_EQ(log.waypoints.size(), job.size());
}

TEST_F(ControllerTest, RefusesAGapAndStaysAsItWas) {
  ASSERT_EQ(open(), Result::kOk);
  fill(8);
  EXPECT_EQ(push(window_of(9, 4)), Result::kGap);
  EXPECT_EQ(status().accepted, 8u);
  EXPECT_EQ(status().last_result, Result::kGap);
}

TEST_F(ControllerTest, AnOldWindowIsADuplicateAndAnOverlapAppendsTheRest) {
  ASSERT_EQ(open(), Result::kOk);
  fill(8);
  EXPECT_EQ(push(window_of(4, 4)), Result::kDup);
  EXPECT_EQ(push(window_of(2, 3)), Result::kDup);
  EXPECT_EQ(status().accepted, 8u);
  EXPECT_EQ(push(window_of(6, 4)), Result::kOk);
  EXPECT_EQ(status().accepted, 10u);
  fill(job.size());
  EXPECT_EQ(push(window_of(job.size() - 4, 4)), Result::kDup);
}

TEST_F(ControllerTest, DifferentContentsForAnAcceptedWaypointAreAFault) {
  ASSERT_EQ(open(), Result::kOk);
  fill(8);
  auto w = window_of(6, 4);
  w.raw[1][5] = static_cast<std::uint8_t>(w.raw[1][5] ^ 1);
  EXPECT_EQ(push(w), Result::kConflict);
  EXPECT_EQ(status().state, State::kFault);
  EXPECT_EQ(status().fault, Fault::kConflict);
  EXPECT_EQ(status().fault_sequence, 7u);
  EXPECT_EQ(push(window_of(8, 4)), Result::kState);
  EXPECT_EQ(send(Op::kStart), Result::kState);
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  EXPECT_EQ(status().state, State::kIdle);
}

TEST_F(ControllerTest, WhatDoesNotFitIsRefusedWhole) {
  use(1, 200, 10);
  ASSERT_EQ(open(), Result::kOk);
  fill(8);
  EXPECT_EQ(status().free, 2);
  EXPECT_EQ(push(window_of(8, 3)), Result::kFull);
  EXPECT_EQ(status().accepted, 8u);
  EXPECT_EQ(push(window_of(8, 2)), Result::kOk);
  EXPECT_EQ(status().free, 0);
}

TEST_F(ControllerTest, AWrongTokenOrChecksumChangesNothing) {
  ASSERT_EQ(open(), Result::kOk);
  auto w = window_of(0, 4);
  w.token = token + 1;
  EXPECT_EQ(push(w), Result::kBadToken);
  w = window_of(0, 4);
  w.crc_ok = false;
  EXPECT_EQ(push(w), Result::kBadCrc);
  EXPECT_EQ(controller->command({make(Op::kAbort, token), false}, kOwner, now_ms * 1000), Result::kBadCrc);
  EXPECT_EQ(send(make(Op::kAbort, token + 1), kOther), Result::kBadToken);
  EXPECT_EQ(status().accepted, 0u);
  EXPECT_EQ(status().state, State::kOpen);
}

TEST_F(ControllerTest, AWindowBeyondALimitIsRefusedWholeWithSequenceAndCode) {
  auto waypoints = testing::sample_waypoints(200);
  waypoints[10].a.p.z() -= 6;  // 6 mm in 50 ms are 120 mm/s
  job = make_job(sha256({}), "S001", waypoints, testing::sample_blade());
  ASSERT_EQ(open(), Result::kOk);
  fill(8);
  EXPECT_EQ(push(window_of(8, 4)), Result::kLimit);
  EXPECT_EQ(status().fault_detail, info(Limit::kSpeed).code);
  EXPECT_EQ(status().fault_sequence, 10u);
  EXPECT_EQ(status().accepted, 8u);
  EXPECT_EQ(status().state, State::kOpen) << "a refusal is no fault";
  EXPECT_EQ(push(window_of(8, 2)), Result::kOk) << "what holds is still taken";
}

TEST_F(ControllerTest, TheLastFlagBelongsToTheLastWaypoint) {
  ASSERT_EQ(open(), Result::kOk);
  auto w = window_of(0, 4);
  w.last = true;
  EXPECT_EQ(push(w), Result::kLimit);
  fill(job.size() - 2);
  w = window_of(job.size() - 2, 2);
  w.last = false;
  EXPECT_EQ(push(w), Result::kLimit);
  EXPECT_EQ(status().fault_detail, info(Limit::kCount).code);
}

TEST_F(ControllerTest, CommandsOutOfPlaceAreRefused) {
  EXPECT_EQ(send(Op::kStart), Result::kState) << "nothing open";
  EXPECT_EQ(push(window_of(0, 4)), Result::kState);
  ASSERT_EQ(open(), Result::kOk);
  EXPECT_EQ(send(Op::kStart), Result::kState) << "no waypoints";
  EXPECT_EQ(send(Op::kHold), Result::kState);
  EXPECT_EQ(send(Op::kResume), Result::kState);
  EXPECT_EQ(send(Op::kReset), Result::kState);
  EXPECT_EQ(send(make(static_cast<Op>(99), token)), Result::kState);
  fill(4);
  EXPECT_EQ(send(Op::kStart), Result::kState) << "no room to stop in";
  fill(100);
  EXPECT_EQ(send(Op::kStart), Result::kOk);
  EXPECT_EQ(send(Op::kClose), Result::kState) << "while it runs";
  auto other_job = make(Op::kHold, token);
  other_job.job_id ^= 1;
  EXPECT_EQ(send(other_job), Result::kState);
}

TEST_F(ControllerTest, AnImpossibleBladeIsNotOpened) {
  auto c = make(Op::kOpen, 0);
  c.blade.thickness_mm = 0;
  EXPECT_EQ(send(c), Result::kLimit);
  c = make(Op::kOpen, 0);
  c.waypoint_count = 0;
  EXPECT_EQ(send(c), Result::kLimit);
  EXPECT_EQ(status().fault_detail, info(Limit::kBlade).code);
  EXPECT_EQ(status().state, State::kIdle);
}

TEST_F(ControllerTest, ASecondClientIsBusyUntilTheLeaseRunsOut) {
  ASSERT_EQ(open(), Result::kOk);
  fill(8);
  const auto first_token = token;
  wait(4000, false);
  EXPECT_EQ(send(make(Op::kOpen, 0), kOther), Result::kBusy);
  ASSERT_EQ(push(window_of(8, 0)), Result::kOk);  // a sign of life
  wait(4900, false);
  EXPECT_EQ(send(make(Op::kOpen, 0), kOther), Result::kBusy);
  wait(200, false);
  EXPECT_EQ(send(make(Op::kOpen, 0), kOther), Result::kOk);
  EXPECT_EQ(status().token, first_token + 1);
  EXPECT_EQ(status().accepted, 8u) << "the prefix is kept";
  EXPECT_EQ(push(window_of(8, 4)), Result::kBadToken) << "the old token is stale";
  EXPECT_EQ(send(Op::kHold), Result::kBadToken);
}

TEST_F(ControllerTest, AnotherJobWaitsUntilNothingHalfCutIsLeft) {
  start_with(100);
  wait(1000, true);
  const Job first = job;
  wait(6000, false);
  EXPECT_EQ(status().state, State::kHeld);
  job = sample_job(50, "S002");
  EXPECT_EQ(send(make(Op::kOpen, 0), kOther), Result::kState);
  job = first;
  EXPECT_EQ(send(make(Op::kAbort, 0), kOther), Result::kOk) << "the lease is out: anybody may clear up";
  EXPECT_EQ(send(make(Op::kReset, 0), kOther), Result::kOk);
  job = sample_job(50, "S002");
  EXPECT_EQ(open(kOther), Result::kLimit) << "the blade stands in the foam";
  job = first;
  EXPECT_EQ(send(make(Op::kRelease, 0), kOther), Result::kOk);
  job = sample_job(50, "S002");
  EXPECT_EQ(open(kOther), Result::kOk);
}

TEST_F(ControllerTest, ALiveOwnerKeepsItsTokenOnAnotherConnection) {
  ASSERT_EQ(open(), Result::kOk);
  EXPECT_EQ(push(window_of(0, 4), 7), Result::kOk);
  EXPECT_EQ(send(make(Op::kOpen, token), 8), Result::kOk);
  EXPECT_EQ(status().token, token);
}

TEST_F(ControllerTest, ARepeatedCommandIsAnsweredButNotCarriedOutAgain) {
  const auto c = make(Op::kOpen, 0);
  ASSERT_EQ(send(c), Result::kOk);
  token = status().token;
  EXPECT_EQ(send(c), Result::kOk);
  EXPECT_EQ(status().token, token);
  fill(job.size());
  ASSERT_EQ(send(Op::kStart), Result::kOk);
  wait(500);
  const auto hold = make(Op::kHold, token);
  ASSERT_EQ(send(hold), Result::kOk);
  wait(1000);
  ASSERT_EQ(send(Op::kResume), Result::kOk);
  wait(20);
  EXPECT_EQ(std::count(log.events.begin(), log.events.end(), "hold"), 1);
  EXPECT_EQ(std::count(log.events.begin(), log.events.end(), "open"), 1);
}

TEST_F(ControllerTest, TheSameJobRunsAgainUnderAnotherRunNumber) {
  use(kAsFastAsDataComes);
  for (run = 1; run <= 2; ++run) {
    start_with(job.size());
    wait(50);  // a burst a tick
    ASSERT_EQ(status().state, State::kDone);
    ASSERT_EQ(send(Op::kClose), Result::kOk);
  }
  EXPECT_EQ(log.waypoints.size(), 2u * job.size());
  EXPECT_EQ(log.waypoints[job.size() - 1].chain, log.waypoints.back().chain);
}

TEST_F(ControllerTest, SilenceOfTheOwnerSlowsDownAlongThePathAndHolds) {
  start_with(job.size());
  wait(1000);
  wait(2600, false);
  EXPECT_EQ(status().state, State::kHeld);
  EXPECT_EQ(status().fault, Fault::kWatchdog);
  // 1 s with the owner, 2 s of watchdog, a quarter of a second of braking path.
  EXPECT_NEAR(status().executed, (1 + 2 + 0.25) / 0.05, 2);
  EXPECT_EQ(status().accepted, job.size()) << "the buffer is kept";
  const auto executed = status().executed;
  wait(500, false);
  EXPECT_EQ(status().executed, executed) << "it stands";
  ASSERT_EQ(send(Op::kResume), Result::kOk);
  wait(9000);
  EXPECT_EQ(status().state, State::kDone);
  EXPECT_EQ(log.waypoints.size(), job.size());
}

TEST_F(ControllerTest, BrakingAndResumingStayBelowTheirShareOfTheAcceleration) {
  start_with(job.size());
  wait(3000);
  ASSERT_EQ(send(Op::kHold), Result::kOk);
  wait(1000);
  ASSERT_EQ(status().state, State::kHeld);
  ASSERT_EQ(send(Op::kResume), Result::kOk);
  wait(9000);
  ASSERT_EQ(status().state, State::kDone);
  // The path's own acceleration plus the ramp of 2 /s times the speed, which stays below 60 mm/s here.
  double worst = 0;
  for (std::size_t i = 2; i < log.poses.size(); ++i) {
    if (log.poses[i].t_us - log.poses[i - 2].t_us != 20000) continue;  // the extra pose of standing still
    const Eigen::Vector3d second = log.poses[i].a.p - 2 * log.poses[i - 1].a.p + log.poses[i - 2].a.p;
    // Linear steps between waypoints put the change of speed of 50 ms into one pose step of 10 ms.
    worst = std::max(worst, second.norm() / 1e-4 / 5);
  }
  EXPECT_LT(worst, 2 * 60 + 30);
}

TEST_F(ControllerTest, RunningOutOfDataStopsInsideItAndIsAFaultOfItsOwn) {
  start_with(40);
  wait(4000);
  EXPECT_EQ(status().state, State::kHeld);
  EXPECT_EQ(status().fault, Fault::kUnderrun);
  EXPECT_LE(log.poses.back().t_us, 3000000u);
  EXPECT_GE(status().executed, 38u);
  EXPECT_LE(status().executed, 40u);
  fill(job.size());
  ASSERT_EQ(send(Op::kResume), Result::kOk);
  wait(9500);
  EXPECT_EQ(status().state, State::kDone);
  EXPECT_EQ(status().fault, Fault::kNone);
  EXPECT_EQ(log.waypoints.size(), job.size());
}

TEST_F(ControllerTest, AConflictWhileMovingBrakesAlongThePath) {
  start_with(job.size());
  wait(2000);
  const auto executed = status().executed;
  auto w = window_of(6, 1);
  w.raw[0][5] ^= 1;
  EXPECT_EQ(push(w), Result::kConflict);
  EXPECT_EQ(send(Op::kReset), Result::kState) << "not while it still moves";
  wait(1000);
  EXPECT_EQ(status().state, State::kFault);
  EXPECT_NEAR(status().executed, executed + 5, 1);
  EXPECT_EQ(send(Op::kReset), Result::kOk);
}

TEST_F(ControllerTest, EstopStopsAtOnceAndLatches) {
  start_with(job.size());
  wait(2000);
  const auto executed = status().executed;
  controller->estop(now_ms * 1000);
  wait(1000);
  EXPECT_EQ(status().state, State::kEstop);
  EXPECT_EQ(status().executed, executed);
  EXPECT_EQ(send(Op::kStart), Result::kState);
  EXPECT_EQ(send(Op::kResume), Result::kState);
  EXPECT_EQ(send(make(Op::kOpen, 0)), Result::kState);
  EXPECT_EQ(push(window_of(status().accepted, 0)), Result::kState);
  EXPECT_FALSE(log.poses.back().heat);
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  EXPECT_EQ(status().state, State::kIdle);
  EXPECT_EQ(open(), Result::kOk);
}

TEST_F(ControllerTest, EstopLatchesWithoutAJobToo) {
  controller->estop(now_ms * 1000);
  EXPECT_EQ(status().state, State::kEstop);
  EXPECT_EQ(open(), Result::kState);
  EXPECT_EQ(send(make(Op::kReset, 0), kOther), Result::kOk);
  EXPECT_EQ(open(), Result::kOk);
}

TEST_F(ControllerTest, AHeldBladeGoesColdAfterTheDwell) {
  start_with(job.size());
  wait(4000);
  ASSERT_TRUE(log.poses.back().heat);
  ASSERT_EQ(send(Op::kHold), Result::kOk);
  wait(1500);
  ASSERT_EQ(status().state, State::kHeld);
  EXPECT_TRUE(log.poses.back().heat);
  wait(2500);
  EXPECT_FALSE(log.poses.back().heat);
  EXPECT_EQ(log.events.back(), "cold");
}

TEST_F(ControllerTest, NothingIsPublishedThatIsNotOnRecord) {
  start_with(job.size());
  wait(1000);
  const auto executed = status().executed;
  log.healthy = false;
  wait(1000);
  EXPECT_EQ(status().state, State::kFault);
  EXPECT_EQ(status().fault, Fault::kLog);
  EXPECT_EQ(status().executed, executed);
  // RESET tries again, and then what had no room is on record, too.
  EXPECT_EQ(send(Op::kReset), Result::kState);
  EXPECT_EQ(status().state, State::kFault);
  EXPECT_EQ(status().fault, Fault::kLog);
  EXPECT_EQ(status().executed, executed);
  log.healthy = true;
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  EXPECT_EQ(status().state, State::kIdle);
  EXPECT_EQ(status().fault, Fault::kNone);
  EXPECT_EQ(status().executed, log.waypoints.size());
  EXPECT_EQ(log.events.back(), "reset");
}

TEST_F(ControllerTest, AfterAnEstopNothingIsClearedWhileTheLogCannotBeWritten) {
  start_with(job.size());
  wait(1000);
  controller->estop(now_ms * 1000);
  log.healthy = false;
  EXPECT_EQ(send(Op::kReset), Result::kState);
  EXPECT_EQ(status().state, State::kEstop);
  EXPECT_EQ(status().fault, Fault::kLog);
  log.healthy = true;
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  EXPECT_EQ(status().fault, Fault::kNone);
}

TEST_F(ControllerTest, AJobThatSnapsBetweenTwoWaypointsIsRefusedThere) {
  use(kAsFastAsDataComes);
  const auto waypoints = testing::snapping_waypoints();
  job = make_job(sha256({}), "S001", waypoints, testing::sample_blade());
  // Where the first refusal comes, and why.
  const auto refused = [&](const BladeCheckOptions& blade) {
    options.blade = blade;
    controller = std::make_unique<Controller>(options, &log);
    EXPECT_EQ(open(), Result::kOk);
    Result result = Result::kOk;
    while (result == Result::kOk && status().accepted < job.size()) {
      const auto at = status().accepted;
      result = push(window_of(at, std::min(4u, job.size() - at)));
    }
    return std::pair{limit_of_code(status().fault_detail), status().fault_sequence};
  };
  const auto [snap, lost] = refused({true, 1, 0});
  EXPECT_EQ(snap, Limit::kBladeSnap);
  EXPECT_GT(lost, 200u) << "well into the turning";
  EXPECT_LT(lost, 490u);
  const auto [margin, unsafe] = refused({true, 1, 1});
  EXPECT_EQ(margin, Limit::kBladeMargin);
  EXPECT_LE(unsafe, lost) << "on the way to the snap";
  EXPECT_EQ(refused({false, 1, 1}).first, Limit::kNone);
  EXPECT_EQ(status().accepted, job.size()) << "without the equilibrium nothing is seen";
}

TEST_F(ControllerTest, ABladeTooSoftForItsBendsIsRefusedWithYield) {
  // E t kappa / 2 reaches 50 MPa where the arc turns by 0.42 rad to either side.
  job.blade.yield_strength_mpa = 40;
  ASSERT_EQ(open(), Result::kOk);
  Result result = Result::kOk;
  while (result == Result::kOk) result = push(window_of(status().accepted, 4));
  EXPECT_EQ(result, Result::kLimit);
  EXPECT_EQ(status().fault_detail, info(Limit::kBladeYield).code);
}

// Where the clamps hold the blade of a logged pose, in clamp A's axes: off by position, mm, and angle, rad.
std::pair<double, double> off_its_clamps(const PoseSample& s) {
  const elastica::ClampPair ends = elastica::clamps_of(*s.blade);
  const Eigen::Vector3d b = s.a.q.conjugate() * (s.b.p - s.a.p);
  const Eigen::Vector3d t = s.a.q.conjugate() * (s.b.q * Eigen::Vector3d::UnitX());
  return {std::hypot(b.x() - ends.b.x, b.y() - ends.b.y),
          std::abs(std::remainder(std::atan2(t.y(), t.x()) - ends.b.theta, 2 * M_PI))};
}

TEST_F(ControllerTest, TheBladeStaysOnItsBranchWhileTheMotionIsHeldLostAndStopped) {
  start_with(job.size());
  wait(2000);
  ASSERT_EQ(send(Op::kHold), Result::kOk);
  wait(1000);
  ASSERT_EQ(send(Op::kResume), Result::kOk);
  wait(1000);
  wait(3000, false);  // the link is lost: slowed down and held
  ASSERT_EQ(status().state, State::kHeld);
  ASSERT_EQ(send(Op::kResume), Result::kOk);
  wait(700);
  controller->estop(now_ms * 1000);
  ASSERT_GT(log.poses.size(), 400u);
  std::optional<elastica::Elastica> last;
  for (const PoseSample& s : log.poses) {
    ASSERT_TRUE(s.blade) << s.t_us;
    EXPECT_LT(off_its_clamps(s).first, 1e-6) << s.t_us;
    EXPECT_LT(off_its_clamps(s).second, 1e-9) << s.t_us;
    // A circular arc, whatever the clock does.
    EXPECT_LT(std::hypot(s.blade->lambda1, s.blade->lambda2) * 640000, 0.1) << s.t_us;
    EXPECT_LT(bend_between(*s.blade, last.value_or(*s.blade)), 0.05) << s.t_us;
    last = s.blade;
  }
  for (const Recorder::Executed& w : log.waypoints) {
    ASSERT_TRUE(w.margins);
    EXPECT_GT(w.margins->margin, 30);
  }
}

TEST_F(ControllerTest, IdentSaysWhatMayBeDone) {
  const auto ident = controller->ident();
  EXPECT_NE(ident.capabilities & protocol::kCapEquilibrium, 0);
  options.blade.equilibrium = false;
  EXPECT_EQ(Controller(options).ident().capabilities & protocol::kCapEquilibrium, 0);
  EXPECT_NE(ident.capabilities & protocol::kCapSimulator, 0);
  EXPECT_EQ(ident.blade_length_mm, 0);
  ASSERT_EQ(open(), Result::kOk);
  EXPECT_EQ(controller->ident().blade_length_mm, 800);
}

}  // namespace
}  // namespace hotblade::robot
