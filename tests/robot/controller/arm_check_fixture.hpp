// A controller with arms, and a job streamed to it by hand.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "robot/controller/controller.hpp"
#include "tests/robot/controller/arm_job.hpp"

namespace hotblade::robot::testing {

class Poses final : public ExecutionSink {
 public:
  void executed(const ExecutedWaypoint&) override {}
  void pose(const PoseSample& sample) override { poses.push_back(sample); }
  void event(const JobEvent& event) override { events.emplace_back(event.what); }
  bool commit() override { return true; }
  std::vector<PoseSample> poses;
  std::vector<std::string> events;
};

// A controller with arms, and the sample job, streamed by hand.
class ArmCheckTest : public ::testing::Test {
 protected:
  static constexpr Controller::Connection kOwner = 1;

  void use(const Cell& with, const Job& work, const ArmCell::Limits& limits = {}) {
    cell = with;
    job = work;
    joints = planned_joints(cell, job);
    ASSERT_EQ(joints[0].size(), job.size()) << "arm R1 does not serve the job";
    ASSERT_EQ(joints[1].size(), job.size()) << "arm R2 does not serve the job";
    begin(limits);
  }
  // A controller whose cell is `cell` as it is now, joints as they were found.
  void begin(const ArmCell::Limits& limits = {}) {
    ControllerOptions options;
    options.arms = shared_cell(cell, limits);
    options.time_scale = kAsFastAsDataComes;
    options.blade.equilibrium = equilibrium;
    options.blade.offsets = options.limits.clamps = offsets;
    options.limits.speed_mm_s = 500;
    options.limits.envelope_min_mm = {-4000, -4000, -4000};
    options.limits.envelope_max_mm = {4000, 4000, 4000};
    controller = std::make_unique<Controller>(options, &log);
    ASSERT_EQ(command(protocol::Op::kOpen, 0), protocol::Result::kOk);
    token = controller->status().token;
  }

  protocol::Result command(protocol::Op op, std::uint32_t with_token) {
    protocol::Command c{++nonce, op, job.id, 1, with_token, 0, {}};
    if (op == protocol::Op::kOpen) {
      c.waypoint_count = job.size();
      c.blade = job.blade;
    }
    const protocol::Result result = controller->command({c, true}, kOwner, 0);
    controller->commit();
    return result;
  }
  protocol::Result declare(protocol::Arms arms) {
    arms.token = token;
    const auto block = protocol::encode_arms(arms);
    return controller->arms(protocol::decode_arms(block), kOwner, 0);
  }
  protocol::Result push() {
    while (controller->status().accepted < job.size()) {
      protocol::Window w;
      w.token = token;
      w.first_sequence = controller->status().accepted;
      w.count = static_cast<std::uint16_t>(std::min<std::uint32_t>(4, job.size() - w.first_sequence));
      w.last = w.first_sequence + w.count == job.size();
      w.crc_ok = true;
      for (std::uint32_t i = 0; i < w.count; ++i) w.raw.at(i) = job.raw.at(w.first_sequence + i);
      if (const protocol::Result result = controller->window(w, kOwner, 0); result != protocol::Result::kOk)
        return result;
      controller->commit();
    }
    return protocol::Result::kOk;
  }
  void run() {
    for (std::uint64_t us = 0; us < 5'000'000 && controller->status().state == protocol::State::kRunning;
         us += 1000) {
      controller->heard(kOwner, us);
      controller->tick(us);
      controller->commit();
    }
  }
  // Everything through acceptance; the limit that breaks, where one does.
  Limit refused() {
    EXPECT_EQ(declare(declared(joints)), protocol::Result::kOk);
    const protocol::Result result = push();
    EXPECT_EQ(result, protocol::Result::kLimit);
    return limit_of_code(controller->status().fault_detail);
  }
  void expect_clean() {
    ASSERT_EQ(declare(declared(joints)), protocol::Result::kOk);
    ASSERT_EQ(push(), protocol::Result::kOk)
        << controller->status().fault_detail << ": "
        << describe(controller->status().arms, limit_of_code(controller->status().fault_detail), {});
    ASSERT_EQ(command(protocol::Op::kStart, token), protocol::Result::kOk);
    run();
    ASSERT_EQ(controller->status().state, protocol::State::kDone)
        << describe(controller->status().arms, limit_of_code(controller->status().fault_detail), {});
  }

  Cell cell;
  Job job;
  std::array<std::vector<JointAngles>, 2> joints;
  Poses log;
  std::unique_ptr<Controller> controller;
  std::uint32_t token = 0, nonce = 0;
  bool equilibrium = true;
  ClampOffsets offsets{};
};

}  // namespace hotblade::robot::testing
