// What a controller answers: it is on record by then, so that no restart knows less than a client does, and a
// command that is answered OK was carried out.
#include <gtest/gtest.h>

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "robot/controller/register_map.hpp"
#include "tests/robot/controller/raw_client.hpp"
#include "tests/robot/controller/simulator_fixture.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

using protocol::Fault;
using protocol::Op;
using protocol::Result;
using protocol::State;
using testing::Bytes;
using testing::pdu;
using testing::sample_job;
using testing::write_pdu;
using testing::write_read_pdu;

// Keeps the changes of state that no commit has seen yet.
class Disk final : public ExecutionSink {
 public:
  void executed(const ExecutedWaypoint&) override {}
  void pose(const PoseSample&) override {}
  void event(const JobEvent& event) override {
    events.emplace_back(event.what);
    ++pending;
  }
  bool commit() override {
    if (room == 0) return false;
    if (room > 0) --room;
    pending = 0;
    if (committing) committing();
    return true;
  }

  std::vector<std::string> events;
  int pending = 0, room = -1;  // so many commits find room; below 0: all
  std::function<void()> committing;
};

// Registers over a controller, and a clock in ms; nobody commits but they.
class OnRecord : public ::testing::Test {
 protected:
  void ask(const Bytes& request_pdu) {
    now_ms_ += 1;
    (void)map_.handle(testing::request(1, request_pdu), 1, now_ms_ * 1000);
    EXPECT_EQ(disk_.pending, 0) << disk_.events.back();
  }
  Result send(Op op, bool reads = true) {
    ++nonce_;
    return repeat(op, reads);
  }
  // The same block again.
  Result repeat(Op op, bool reads = true) {
    protocol::Command c{nonce_, op, job_.id, 1, controller_.status().token, 0, {}};
    if (op == Op::kOpen) {
      c.token = 0;
      c.waypoint_count = job_.size();
      c.blade = job_.blade;
    }
    const auto block = protocol::encode_command(c);
    ask(reads ? write_read_pdu(protocol::kCommandBase, block) : write_pdu(protocol::kCommandBase, block));
    return controller_.status().last_result;
  }
  void push(std::uint32_t first, bool spoilt = false) {
    auto raw = std::vector(job_.raw.begin() + first, job_.raw.begin() + first + 4);
    if (spoilt) raw[1][5] ^= 1;
    const auto window =
        protocol::encode_window(controller_.status().token, first, first + 4 == job_.size(), raw);
    ask(write_read_pdu(protocol::kWindowBase, window.span()));
  }
  void start() {
    ASSERT_EQ(send(Op::kOpen), Result::kOk);
    for (std::uint32_t at = 0; at < job_.size(); at += 4) push(at);
    ASSERT_EQ(send(Op::kStart), Result::kOk);
  }
  void read_status() { ask(pdu(3, {protocol::kStatusBase, protocol::kStatusSize})); }
  void estop() { ask(pdu(6, {protocol::kEstopBase, 1})); }
  [[nodiscard]] State state() const { return controller_.status().state; }

  Job job_ = sample_job(200);
  Disk disk_;
  Controller controller_{ControllerOptions{}, &disk_};
  RegisterMap map_{controller_};
  std::uint64_t now_ms_ = 1000;
  std::uint32_t nonce_ = 100;
};

TEST_F(OnRecord, WhateverIsAnswered) {
  start();
  now_ms_ += 1000;
  send(Op::kHold, false);
  now_ms_ += 1000;
  read_status();
  EXPECT_EQ(state(), State::kHeld);
  EXPECT_EQ(send(Op::kResume), Result::kOk);
  now_ms_ += 500;
  estop();
  EXPECT_EQ(disk_.events.back(), "estop");
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  EXPECT_EQ(disk_.events.back(), "reset");
  estop();
  EXPECT_EQ(send(Op::kReset, false), Result::kOk);
}

TEST_F(OnRecord, AConflictAnAbortAndAnEndThatTimeBrings) {
  start();
  push(0, true);
  EXPECT_EQ(disk_.events.back(), "fault");
  now_ms_ += 1000;
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  start();
  EXPECT_EQ(send(Op::kAbort, false), Result::kOk);
  EXPECT_EQ(disk_.events.back(), "fault");
  now_ms_ += 1000;
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  start();
  now_ms_ += 10500;
  read_status();
  EXPECT_EQ(state(), State::kDone);
  EXPECT_EQ(send(Op::kClose), Result::kOk);
  EXPECT_EQ(disk_.events.back(), "close");
}

TEST_F(OnRecord, AnEstopStandsBeforeTheDiskAnswers) {
  start();
  now_ms_ += 1000;
  int commits = 0;
  disk_.committing = [&] {
    ++commits;
    EXPECT_EQ(state(), State::kEstop);
  };
  estop();
  EXPECT_EQ(commits, 1);
}

TEST_F(OnRecord, NothingBeginsToMoveWithoutRoomForItsLine) {
  ASSERT_EQ(send(Op::kOpen), Result::kOk);
  for (std::uint32_t at = 0; at < job_.size(); at += 4) push(at);
  disk_.room = 0;
  protocol::Command c{++nonce_, Op::kStart, job_.id, 1, controller_.status().token, 0, {}};
  EXPECT_EQ(controller_.command({c, true}, 1, now_ms_ * 1000), Result::kState);
  now_ms_ += 1000;
  controller_.tick(now_ms_ * 1000);
  EXPECT_EQ(state(), State::kFault);
  EXPECT_EQ(controller_.status().fault, Fault::kLog);
  controller_.commit();
  EXPECT_EQ(controller_.status().executed, 0u);
}

TEST_F(OnRecord, ACloseWithoutRoomForItsLineIsAFault) {
  ASSERT_EQ(send(Op::kOpen), Result::kOk);
  disk_.room = 0;
  protocol::Command c{++nonce_, Op::kClose, job_.id, 1, controller_.status().token, 0, {}};
  EXPECT_EQ(controller_.command({c, true}, 1, now_ms_ * 1000), Result::kState);
  EXPECT_EQ(state(), State::kFault);
  EXPECT_EQ(controller_.status().fault, Fault::kLog);
  disk_.room = -1;
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  EXPECT_EQ(state(), State::kIdle);
}

// The disk takes what it lacked, but not the line of the RESET.
TEST_F(OnRecord, AResetWithoutRoomForItsLineClearsNothing) {
  start();
  now_ms_ += 1000;
  estop();
  disk_.room = 1;
  protocol::Command c{++nonce_, Op::kReset, job_.id, 1, controller_.status().token, 0, {}};
  EXPECT_EQ(controller_.command({c, true}, 1, now_ms_ * 1000), Result::kState);
  EXPECT_EQ(state(), State::kEstop);
  EXPECT_EQ(controller_.status().fault, Fault::kLog);
  EXPECT_EQ(disk_.events.back(), "estop") << "for whoever reads both lines once there is room";
  disk_.room = -1;
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  EXPECT_EQ(state(), State::kIdle);
}

TEST_F(OnRecord, AnEstopWithoutRoomForItsLineStandsWithTheReason) {
  start();
  now_ms_ += 1000;
  disk_.room = 0;
  controller_.estop(now_ms_ * 1000);
  controller_.record_changes();
  EXPECT_EQ(state(), State::kEstop);
  EXPECT_EQ(controller_.status().fault, Fault::kLog);
}

// A blade that was freed stays so.
TEST_F(OnRecord, AnEstopAfterReleaseLeavesNothingInTheCut) {
  start();
  now_ms_ += 4000;
  estop();
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  ASSERT_TRUE(controller_.status().left_in_cut);
  EXPECT_EQ(send(Op::kRelease), Result::kOk);
  estop();
  EXPECT_EQ(send(Op::kReset), Result::kOk);
  EXPECT_FALSE(controller_.status().left_in_cut);
}

// But for the block that was sent before: its answer may have been lost.
TEST_F(OnRecord, ACommandThatWouldDoNothingIsRefused) {
  start();
  now_ms_ += 500;
  EXPECT_EQ(send(Op::kStart), Result::kState) << "it runs";
  EXPECT_EQ(send(Op::kResume), Result::kState) << "it runs";
  EXPECT_EQ(send(Op::kHold), Result::kOk);
  now_ms_ += 100;
  EXPECT_EQ(repeat(Op::kHold), Result::kOk);
  EXPECT_EQ(send(Op::kStart), Result::kState) << "it slows down";
  EXPECT_EQ(send(Op::kResume), Result::kState) << "it slows down";
  now_ms_ += 1000;
  read_status();
  ASSERT_EQ(state(), State::kHeld);
  EXPECT_EQ(send(Op::kHold), Result::kState) << "it is held";
  EXPECT_EQ(send(Op::kStart), Result::kState) << "it is held";
  EXPECT_EQ(send(Op::kWithdraw), Result::kOk);
  now_ms_ += 100;
  EXPECT_EQ(repeat(Op::kWithdraw), Result::kOk);
  for (const Op op : {Op::kWithdraw, Op::kStart, Op::kResume})
    EXPECT_EQ(send(op), Result::kState) << protocol::name(op) << " on the way back";
  EXPECT_EQ(state(), State::kRunning);
}

TEST_F(OnRecord, AFaultIsForgottenWithItsWaypointWhenTheMotionGoesOn) {
  start();
  now_ms_ += 1000;
  controller_.tick((now_ms_ += 3000) * 1000);
  now_ms_ += 1000;
  read_status();
  ASSERT_EQ(controller_.status().fault, Fault::kWatchdog);
  ASSERT_GT(controller_.status().fault_sequence, 0u);
  EXPECT_EQ(send(Op::kResume), Result::kOk);
  EXPECT_EQ(controller_.status().fault, Fault::kNone);
  EXPECT_EQ(controller_.status().fault_sequence, 0u);
}

TEST_F(OnRecord, FlagsThatAreUnknownOrOutOfPlaceAreRefused) {
  ASSERT_EQ(send(Op::kOpen), Result::kOk);
  const auto flagged = [&](std::uint32_t n, std::uint16_t flags) {
    const auto raw = std::span(job_.raw).first(n);
    auto window = protocol::encode_window(controller_.status().token, 0, false, raw);
    window.registers[5] = flags;
    const std::uint32_t crc = protocol::crc32_registers(std::span(window.registers).first(window.size - 2));
    window.registers[window.size - 2] = static_cast<std::uint16_t>(crc >> 16);
    window.registers[window.size - 1] = static_cast<std::uint16_t>(crc & 0xFFFF);
    ask(write_read_pdu(protocol::kWindowBase, window.span()));
    return controller_.status().last_result;
  };
  EXPECT_EQ(flagged(4, 2), Result::kLimit);
  EXPECT_EQ(flagged(4, 0x8000), Result::kLimit);
  EXPECT_EQ(flagged(0, 2), Result::kLimit);
  EXPECT_EQ(flagged(0, 1), Result::kLimit) << "no window of no waypoints ends with the last";
  EXPECT_EQ(controller_.status().fault_detail, info(Limit::kCount).code);
  EXPECT_EQ(flagged(0, 0), Result::kOk);
  EXPECT_EQ(flagged(4, 0), Result::kOk);
}

// As whoever restarts it finds the file at the moment of the answer.
TEST(OnDisk, AnEstopAndItsReset) {
  testing::Simulator simulator{ControllerOptions{}};
  testing::RawClient client{simulator.port()};
  std::uint32_t nonce = 0;
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(client.ask(testing::request(1, pdu(6, {protocol::kEstopBase, 1}))).size(), 12u);
    EXPECT_EQ(read_controller_journal(simulator.log_file()).state, State::kEstop) << i;
    const auto reset = protocol::encode_command({++nonce, Op::kReset, 0, 0, 0, 0, {}});
    ASSERT_EQ(client.ask(testing::request(1, write_pdu(protocol::kCommandBase, reset))).size(), 12u);
    EXPECT_EQ(read_controller_journal(simulator.log_file()).state, State::kIdle) << i;
  }
}

}  // namespace
}  // namespace hotblade::robot
