#include "robot/controller/simulated_faults.hpp"

#include <gmock/gmock.h>

#include "robot/controller/controller.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

using protocol::Fault;
using protocol::Op;
using protocol::Result;
using protocol::State;
using ::testing::HasSubstr;
using testing::sample_job;

SimulatedFaults faults(const std::string& spec) {
  SimulatedFaults result;
  result.add(spec);
  return result;
}

TEST(SimulatedFaults, EverySpecIsUnderstood) {
  EXPECT_EQ(faults("slow=0.5").slow, 0.5);
  EXPECT_EQ(faults("fault@120").drive_at, 120u);
  EXPECT_EQ(faults("stall").stall_at, 0u);
  EXPECT_EQ(faults("stall@7").stall_at, 7u);
  EXPECT_EQ(faults("reboot@0").reboot_at, 0u);
  EXPECT_EQ(faults("estop@3.5").estop_at_s, 3.5);
}

TEST(SimulatedFaults, ANumberThatIsNoneIsAnsweredWithAnExampleOfItsKind) {
  for (const std::string right : {"slow=0.5", "fault@120", "stall@120", "reboot@120", "estop@3.5"}) {
    try {
      (void)faults(right + "x");
      ADD_FAILURE() << right;
    } catch (const FaultSpecError& error) {
      EXPECT_TRUE(std::string(error.what()).ends_with("write it as in " + right)) << error.what();
    }
  }
}

TEST(SimulatedFaults, ABadSpecIsNamedWithItsRange) {
  const auto message = [](const std::string& spec) -> std::string {
    try {
      (void)faults(spec);
    } catch (const FaultSpecError& error) {
      return error.what();
    }
    return "accepted";
  };
  for (const char* spec : {"slow=0",
                           "slow=1.1",
                           "slow=-1",
                           "slow=nan",
                           "slow=inf",
                           "slow=",
                           "slow=half",
                           "slow@1",
                           "fault",
                           "fault@",
                           "fault@-1",
                           "fault@1.5",
                           "fault@99999999999",
                           "fault=3",
                           "estop@-1",
                           "estop@nan",
                           "estop",
                           "reboot",
                           "reboot@x",
                           "stall=1",
                           "stall@",
                           "",
                           "@",
                           "melt"}) {
    EXPECT_THAT(message(spec), ::testing::StartsWith(std::string(spec) + ": ")) << spec;
  }
  EXPECT_THAT(message("slow=2"), HasSubstr("(2, 0.001 to 1)"));
  EXPECT_THAT(message("melt"), HasSubstr("reboot@WAYPOINT"));
}

// A job under way on a machine with one of the faults; a tick is 5 ms.
struct Machine {
  explicit Machine(const std::string& spec, double time_scale = 1) {
    ControllerOptions options;
    options.time_scale = time_scale;
    options.faults = faults(spec);
    controller = std::make_unique<Controller>(options);
    send(Op::kOpen);
    for (std::uint32_t k = 0; k < job.size(); k += 4) {
      protocol::Window w{controller->status().token, k, 4, k + 4 == job.size(), true, {}};
      std::copy_n(job.raw.begin() + k, 4, w.raw.begin());
      EXPECT_EQ(controller->window(w, 1, now_us), Result::kOk);
    }
    EXPECT_EQ(send(Op::kStart), Result::kOk);
  }
  Result send(Op op) {
    return controller->command(
        {{++nonce, op, job.id, 1, controller->status().token, job.size(), job.blade}, true}, 1, now_us);
  }
  void wait(double seconds) {
    for (const auto end = now_us + static_cast<std::uint64_t>(seconds * 1e6); now_us < end;) {
      now_us += 5000;
      controller->heard(1, now_us);
      controller->tick(now_us);
      controller->commit();
      worst_following_um = std::max(worst_following_um, status().following_um);
    }
  }
  [[nodiscard]] protocol::Status status() const { return controller->status(); }

  Job job = sample_job(200);
  std::unique_ptr<Controller> controller;
  std::uint64_t now_us = 0;
  std::uint32_t nonce = 0, worst_following_um = 0;
};

TEST(SimulatedFaults, SlowDrivesTakeLongerAndTrailButArrive) {
  Machine machine("slow=0.5");
  machine.wait(10.5);
  EXPECT_EQ(machine.status().state, State::kRunning);
  EXPECT_NEAR(machine.status().executed, 105, 3) << "half of the speed";
  machine.wait(10);
  EXPECT_EQ(machine.status().state, State::kDone);
  EXPECT_EQ(machine.status().executed, machine.job.size());
  EXPECT_GT(machine.worst_following_um, 100u);
  EXPECT_LT(machine.worst_following_um, 1000u) << "10 ms at less than 60 mm/s";
  EXPECT_EQ(machine.status().following_um, 0u) << "at rest";
}

TEST(SimulatedFaults, AHealthyMachineFollows) {
  Machine machine("slow=1");
  machine.wait(10.5);
  EXPECT_EQ(machine.status().state, State::kDone);
  EXPECT_EQ(machine.worst_following_um, 0u);
}

TEST(SimulatedFaults, ADriveFaultBrakesAlongThePathAndNamesItsWaypoint) {
  Machine machine("fault@60");
  machine.wait(4);
  EXPECT_EQ(machine.status().state, State::kFault);
  EXPECT_EQ(machine.status().fault, Fault::kDrive);
  EXPECT_EQ(machine.status().fault_sequence, 60u);
  EXPECT_NEAR(machine.status().executed, 66, 1) << "a quarter of a second of path to brake in";
  EXPECT_EQ(machine.send(Op::kReset), Result::kOk);
}

TEST(SimulatedFaults, StalledClampsAreNoticedByTheFollowingError) {
  for (const double time_scale : {1.0, kAsFastAsDataComes}) {
    Machine machine("stall@60", time_scale);
    machine.wait(5);
    EXPECT_EQ(machine.status().state, State::kFault);
    EXPECT_EQ(machine.status().fault, Fault::kFollowing);
    EXPECT_EQ(machine.status().executed, 61u);
    EXPECT_EQ(machine.send(Op::kReset), Result::kOk);
  }
}

TEST(SimulatedFaults, AStallWhereThePathStandsIsNoticedToo) {
  Machine machine("stall");
  machine.wait(3);
  EXPECT_EQ(machine.status().fault, Fault::kFollowing);
}

TEST(SimulatedFaults, EstopComesAtItsTimeOfTheMotionClock) {
  for (const double time_scale : {1.0, 10.0, kAsFastAsDataComes}) {
    Machine machine("estop@3.52", time_scale);
    machine.wait(5);
    EXPECT_EQ(machine.status().state, State::kEstop);
    EXPECT_EQ(machine.status().executed, 71u) << "0 to 3.50 s";
    EXPECT_EQ(machine.send(Op::kReset), Result::kOk);
    EXPECT_EQ(machine.status().state, State::kIdle);
  }
}

TEST(SimulatedFaults, ARebootStopsAtItsWaypoint) {
  for (const double time_scale : {1.0, kAsFastAsDataComes}) {
    Machine machine("reboot@60", time_scale);
    machine.wait(5);
    EXPECT_TRUE(machine.controller->reboot_due());
    EXPECT_EQ(machine.status().executed, 61u);
    EXPECT_FALSE(machine.controller->options().faults.reboot_at) << "once";
  }
}

}  // namespace
}  // namespace hotblade::robot
