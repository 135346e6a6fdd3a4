#include <gtest/gtest.h>
#include <modbus.h>
#include <signal.h>
#include <sys/wait.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "robot/client/client.hpp"
#include "tests/robot/controller/fault_proxy.hpp"
#include "tests/robot/controller/simulator_fixture.hpp"
#include "tests/robot/wire/sample_job.hpp"

namespace hotblade::robot {
namespace {

using protocol::Fault;
using protocol::State;
using testing::FaultProxy;
using testing::LinkFault;
using testing::sample_job;
using testing::Simulator;

ControllerOptions fast() {
  ControllerOptions options;
  options.time_scale = kAsFastAsDataComes;
  return options;
}

StreamOptions to_port(std::uint16_t port) {
  StreamOptions options;
  options.port = port;
  options.poll_ms = 2;
  options.response_ms = 100;
  options.link_down_ms = 5000;
  return options;
}

// An answer that is late on a busy machine is none of the losses that a test counts.
StreamOptions patient(std::uint16_t port) {
  StreamOptions options = to_port(port);
  options.response_ms = 3000;
  return options;
}

void expect_executed_as_planned(Simulator& simulator, const Job& job) {
  const auto proof = simulator.proof_of(job);
  EXPECT_EQ(proof.executed, proof.planned);
  EXPECT_TRUE(proof.in_order);
  EXPECT_TRUE(proof.bytes_equal);
  EXPECT_TRUE(proof.chain_equal);
}

TEST(Stream, ExecutesAJobAsPlanned) {
  Simulator simulator(fast());
  const Job job = sample_job(3000);
  const auto report = stream(job, patient(simulator.port()));
  EXPECT_EQ(report.outcome, StreamOutcome::kDone) << report.message;
  EXPECT_EQ(report.executed, job.size());
  EXPECT_EQ(report.reconnects, 0);
  expect_executed_as_planned(simulator, job);
}

TEST(Stream, ExecutesAJobOfOneWaypoint) {
  Simulator simulator(fast());
  const Job job = sample_job(1);
  const auto report = stream(job, to_port(simulator.port()));
  EXPECT_EQ(report.outcome, StreamOutcome::kDone) << report.message;
  expect_executed_as_planned(simulator, job);
}

class StreamThroughFaults : public ::testing::TestWithParam<unsigned> {};

TEST_P(StreamThroughFaults, TwentyCutsAtRandomMomentsLeaveNoTrace) {
  Simulator simulator(fast());
  FaultProxy proxy(simulator.port(),
                   {LinkFault::kCutBefore, LinkFault::kCutWithinRequest, LinkFault::kCutAfter,
                    LinkFault::kCutWithinAnswer},
                   20, 12, GetParam());
  const Job job = sample_job(3000);
  const auto report = stream(job, patient(proxy.port()));
  EXPECT_EQ(report.outcome, StreamOutcome::kDone) << report.message;
  EXPECT_EQ(proxy.faults_done(), 20);
  EXPECT_EQ(report.reconnects, 20);
  expect_executed_as_planned(simulator, job);
}

TEST_P(StreamThroughFaults, AnswersLostAfterTheWriteWasExecutedLeaveNoTrace) {
  Simulator simulator(fast());
  FaultProxy proxy(simulator.port(), {LinkFault::kCutAfter}, 60, 5, GetParam());
  const Job job = sample_job(3000);
  const auto report = stream(job, to_port(proxy.port()));
  EXPECT_EQ(report.outcome, StreamOutcome::kDone) << report.message;
  EXPECT_EQ(proxy.faults_done(), 60);
  expect_executed_as_planned(simulator, job);
}

TEST_P(StreamThroughFaults, SilentLateAndRepeatedAnswersLeaveNoTrace) {
  Simulator simulator(fast());
  FaultProxy proxy(simulator.port(),
                   {LinkFault::kSwallowAnswer, LinkFault::kLateAnswer, LinkFault::kRepeatAnswer}, 8, 10,
                   GetParam());
  const Job job = sample_job(1000);
  const auto report = stream(job, to_port(proxy.port()));
  EXPECT_EQ(report.outcome, StreamOutcome::kDone) << report.message;
  EXPECT_EQ(proxy.faults_done(), 8);
  expect_executed_as_planned(simulator, job);
}

INSTANTIATE_TEST_SUITE_P(Seeds, StreamThroughFaults, ::testing::Values(1u, 2u, 3u, 4u));

TEST(Stream, AnyRequestMayLoseItsAnswerAgainAndAgain) {
  // Between one lost answer and the next at most three requests pass, so IDENT, STATUS, OPEN, windows, START
  // and CLOSE are all hit, their repetitions included.
  const Job job = sample_job(100);
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Simulator simulator(fast());
    FaultProxy proxy(simulator.port(), {LinkFault::kCutAfter}, 1000, 2, seed);
    const auto report = stream(job, to_port(proxy.port()));
    EXPECT_EQ(report.outcome, StreamOutcome::kDone) << "seed " << seed << ": " << report.message;
    expect_executed_as_planned(simulator, job);
  }
}

TEST(Stream, AWatchdogHoldDuringALongCutIsResumed) {
  ControllerOptions options;
  options.time_scale = 4;
  options.watchdog_ms = 100;
  Simulator simulator(options);
  FaultProxy proxy(simulator.port(), {LinkFault::kLateAnswer}, 3, 60, 5);
  const Job job = sample_job(200);  // 2.5 s
  StreamOptions stream_options = to_port(proxy.port());
  const auto report = stream(job, stream_options);
  EXPECT_EQ(report.outcome, StreamOutcome::kDone) << report.message;
  EXPECT_EQ(proxy.faults_done(), 3);
  simulator.stop();
  std::ifstream log(simulator.log_file());
  const std::string text((std::istreambuf_iterator<char>(log)), {});
  EXPECT_NE(text.find("\"fault\":\"WATCHDOG\""), std::string::npos) << "the motion was held on the way";
  expect_executed_as_planned(simulator, job);
}

TEST(Stream, ProgressGoesForwardAndEndsComplete) {
  ControllerOptions options;
  options.time_scale = 10;
  Simulator simulator(options);
  const Job job = sample_job(200);
  StreamOptions stream_options = to_port(simulator.port());
  std::vector<StreamProgress> seen;
  stream_options.progress = [&](const StreamProgress& p) { seen.push_back(p); };
  ASSERT_EQ(stream(job, stream_options).outcome, StreamOutcome::kDone);
  ASSERT_GT(seen.size(), 3u);
  for (std::size_t i = 1; i < seen.size(); ++i) {
    EXPECT_GE(seen[i].executed, seen[i - 1].executed);
    EXPECT_LE(seen[i].left_s, seen[i - 1].left_s);
  }
  EXPECT_EQ(seen.back().executed, job.size());
  EXPECT_EQ(seen.back().left_s, 0);
}

TEST(Stream, ASecondClientIsRefusedWhileTheFirstOwnsTheJob) {
  ControllerOptions options;
  Simulator simulator(options);
  const Job job = sample_job(200), other = sample_job(200, "S002");
  std::atomic<bool> enough = false;
  StreamOptions first = to_port(simulator.port());
  first.interrupted = [&] { return enough.load(); };
  StreamReport first_report;
  std::thread owner([&] { first_report = stream(job, first); });
  while (look(to_port(simulator.port())).status.state != State::kRunning) std::this_thread::yield();
  const auto refused = stream(other, to_port(simulator.port()));
  EXPECT_EQ(refused.outcome, StreamOutcome::kRefused);
  EXPECT_NE(refused.message.find("BUSY"), std::string::npos) << refused.message;
  const auto same_job = stream(job, to_port(simulator.port()));
  EXPECT_EQ(same_job.outcome, StreamOutcome::kRefused);
  EXPECT_NE(same_job.message.find("--resume"), std::string::npos) << same_job.message;
  EXPECT_EQ(look(to_port(simulator.port())).status.state, State::kRunning) << "the owner is not disturbed";
  enough = true;
  owner.join();
  EXPECT_EQ(first_report.outcome, StreamOutcome::kInterrupted);
}

TEST(Stream, AnInterruptedJobIsHeldAndResumed) {
  ControllerOptions options;
  options.time_scale = 4;
  options.lease_ms = 300;
  Simulator simulator(options);
  const Job job = sample_job(200);
  StreamOptions first = to_port(simulator.port());
  std::uint32_t executed = 0;
  first.progress = [&](const StreamProgress& p) { executed = p.executed; };
  first.interrupted = [&] { return executed > 50; };
  const auto report = stream(job, first);
  EXPECT_EQ(report.outcome, StreamOutcome::kInterrupted);
  EXPECT_EQ(look(to_port(simulator.port())).status.state, State::kHeld);
  StreamOptions second = to_port(simulator.port());
  second.resume = true;
  const auto resumed = stream(job, second);
  EXPECT_EQ(resumed.outcome, StreamOutcome::kDone) << resumed.message;
  EXPECT_GT(resumed.token, report.token);
  EXPECT_EQ(resumed.run, report.run);
  expect_executed_as_planned(simulator, job);
}

TEST(Stream, AKilledClientIsTakenOverByTheNext) {
  for (const int after_ms : {60, 150, 350}) {
    ControllerOptions options;
    options.time_scale = 10;
    options.lease_ms = 400;
    options.watchdog_ms = 200;
    Simulator simulator(options);
    const Job job = sample_job(200);
    const std::uint16_t port = simulator.port();
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      (void)stream(job, to_port(port));
      ::_exit(0);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
    ASSERT_EQ(::kill(child, SIGKILL), 0);
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status)) << "killed in the middle";
    StreamOptions next = to_port(port);
    next.resume = true;
    const auto report = stream(job, next);
    EXPECT_EQ(report.outcome, StreamOutcome::kDone) << report.message;
    expect_executed_as_planned(simulator, job);
  }
}

TEST(Stream, AJobThatIsClosedIsNotOpenedAgainToGoOnWithIt) {
  Simulator simulator(fast());
  const Job job = sample_job(200);
  StreamOptions options = patient(simulator.port());
  const auto first = stream(job, options);
  ASSERT_EQ(first.outcome, StreamOutcome::kDone) << first.message;

  options.resume = true;
  int opened = 0;
  options.opened = [&](std::uint32_t, std::uint32_t) { ++opened; };
  const auto again = stream(job, options);
  EXPECT_EQ(again.outcome, StreamOutcome::kDone) << again.message;
  EXPECT_EQ(again.executed, job.size());
  EXPECT_EQ(again.run, first.run);
  EXPECT_EQ(again.windows, 0u);
  EXPECT_EQ(opened, 0);

  options.resume = false;  // the same job in another block
  const auto anew = stream(job, options);
  EXPECT_EQ(anew.outcome, StreamOutcome::kDone) << anew.message;
  EXPECT_EQ(anew.run, first.run + 1);
  EXPECT_EQ(opened, 1);
  expect_executed_as_planned(simulator, job);
}

TEST(Stream, AFaultNamesWaypointLimitAndValue) {
  Simulator simulator(fast());
  auto waypoints = testing::sample_waypoints(300);
  waypoints[150].b.p.y() += 20;
  const Job job = make_job(sha256({}), "S007", waypoints, testing::sample_blade());
  const auto report = stream(job, to_port(simulator.port()));
  EXPECT_EQ(report.outcome, StreamOutcome::kRefused);
  EXPECT_NE(report.message.find("S007"), std::string::npos);
  EXPECT_NE(report.message.find("waypoint 150: speed (limit 100 mm/s)"), std::string::npos) << report.message;
}

TEST(Stream, EstopEndsTheStreamWithAMessage) {
  ControllerOptions options;
  Simulator simulator(options);
  const Job job = sample_job(200);
  StreamReport report;
  std::thread owner([&] { report = stream(job, to_port(simulator.port())); });
  while (look(to_port(simulator.port())).status.executed < 5) std::this_thread::yield();
  modbus_t* bystander = modbus_new_tcp("127.0.0.1", simulator.port());
  ASSERT_EQ(modbus_connect(bystander), 0);
  EXPECT_EQ(modbus_write_register(bystander, protocol::kEstopBase, 1), 1);
  modbus_close(bystander);
  modbus_free(bystander);
  owner.join();
  EXPECT_EQ(report.outcome, StreamOutcome::kFault);
  EXPECT_NE(report.message.find("ESTOP"), std::string::npos) << report.message;
  EXPECT_EQ(look(to_port(simulator.port())).status.state, State::kEstop);
}

TEST(Stream, NoControllerIsALostLink) {
  std::uint16_t port = 0;
  {
    Simulator gone(fast());
    port = gone.port();
  }
  StreamOptions options = to_port(port);
  options.link_down_ms = 200;
  const auto report = stream(sample_job(10), options);
  EXPECT_EQ(report.outcome, StreamOutcome::kLinkLost);
  EXPECT_NE(report.message.find("127.0.0.1:" + std::to_string(port)), std::string::npos);
}

TEST(Stream, AControllerThatForgotTheJobEndsTheStream) {
  const Job job = sample_job(2000);
  ControllerOptions options;
  Simulator simulator(options);
  StreamReport report;
  std::thread owner([&] { report = stream(job, to_port(simulator.port())); });
  while (look(to_port(simulator.port())).status.executed < 5) std::this_thread::yield();
  // Somebody stops the machine and clears it: the job is gone.
  modbus_t* bystander = modbus_new_tcp("127.0.0.1", simulator.port());
  ASSERT_EQ(modbus_connect(bystander), 0);
  const auto token = look(to_port(simulator.port())).status.token;
  const auto reset = protocol::encode_command({77, protocol::Op::kReset, job.id, 1, token, 0, {}});
  EXPECT_EQ(modbus_write_register(bystander, protocol::kEstopBase, 1), 1);
  EXPECT_EQ(modbus_write_registers(bystander, protocol::kCommandBase, reset.size(), reset.data()),
            static_cast<int>(reset.size()));
  modbus_close(bystander);
  modbus_free(bystander);
  owner.join();
  EXPECT_NE(report.outcome, StreamOutcome::kDone);
  EXPECT_LT(report.executed, job.size());
}

}  // namespace
}  // namespace hotblade::robot
